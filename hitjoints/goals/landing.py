"""Where a hit box comes to rest, and how surely: many hits within the stated spreads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.goals.box_hit import Boxes
from hitjoints.goals.box_rest import level_axes, send_boxes, strike_boxes
from hitjoints.goals.leaning import turned
from hitjoints.goals.slide_path import SlidePath
from hitjoints.goals.sliding import Support, slide_steps
from hitjoints.told import Told
from hitjoints.vectors import number, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

SAMPLES, MOST_SAMPLES = 1000, 1_000_000
LEVEL = 1e-3
"""Greatest vertical part of a direction that counts as level."""
POINT_SIZE = (1e-3, 1e-3, 1e-3)
"""m, of an object whose size is not given: a point does not turn."""


@dataclass(frozen=True, eq=False, repr=False)
class Landing(Told):
    """Where the object comes to rest: the place of the hit, moved as the object's centre is.

    Attributes:
        nominal: (3,) m, without any spread.
        yaw: rad, turned on the way, without any spread.
        mean: (3,) m.
        covariance: (2, 2) m^2, horizontal.
        samples: (N, 2) m, horizontal places, of those that slide.
        goal: (3,) m; without one, the nominal place.
        tolerance: m.
        within: share of the tries that rest within the tolerance of the goal.
        lost: share of the tries that miss the face or slide on an edge, and count as not there.
    """

    nominal: Array
    yaw: float
    mean: Array
    covariance: Array
    samples: Array
    goal: Array
    tolerance: float
    within: float
    lost: float = 0.0

    @property
    def words(self) -> str:
        """Where it rests, in a line."""
        x, y, z = self.mean
        share = f"within {self.tolerance:g} m of the goal in {100 * self.within:.0f} of 100"
        return f"({x:.3f}, {y:.3f}, {z:.3f}) m, {share}"

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it, without the samples."""
        return {
            "nominal": self.nominal.tolist(),
            "yaw": self.yaw,
            "mean": self.mean.tolist(),
            "covariance": self.covariance.tolist(),
            "goal": self.goal.tolist(),
            "tolerance": self.tolerance,
            "within": self.within,
            "lost": self.lost,
        }


def landing(  # noqa: PLR0913
    robot: Robot,
    q: ArrayLike,
    hit: Hit,
    speed: float,
    *,
    off_centre: float = 0.0,
    height: float = 0.0,
    tolerance: float | None = None,
    support: Support = "face",
    samples: int = SAMPLES,
    seed: int = 0,
) -> Landing:
    """Predict where a box comes to rest that is hit level, on a table, within the hit's spreads.

    Args:
        robot: the arm.
        q: (n,) rad, at the impact.
        hit: the box: mass, restitution and friction are needed; size and yaw where it may turn;
            spread for what is not known exactly.
        speed: m/s, of the contact along the hit's direction at the impact.
        off_centre: m, to the left from the line of the hit to the box's centre.
        height: m, of the contact above the box's centre of mass.
        tolerance: m, around the goal; the hit's.
        support: what carries the box, its "face" or its four "corners".
        samples: how many hits are tried.
        seed: of the spreads.

    Raises:
        InputError: an argument cannot be used, or the direction is not level.
        InfeasibleError: the box would be missed, tip, or slide on its edge.
    """
    _check(hit, speed)
    tolerance = hit.setting.tolerance if tolerance is None else tolerance
    tolerance = number(tolerance, "tolerance", "it is above 0 m", lambda value: value > 0)
    samples = whole(samples, "samples", 2, MOST_SAMPLES)
    drawn = _draw(hit, samples, seed)
    kept = _boxes(hit, drawn, off_centre, height, support).on_the_face
    kept[0] = True  # the hit that was asked for is refused if it misses
    drawn = {name: values[kept] for name, values in drawn.items()}
    boxes = _boxes(hit, drawn, off_centre, height, support)
    _, slide = send_boxes(robot, q, hit, boxes, speed * drawn["speed"], drawn["restitution"])
    places = hit.position[:2] + slide.displacement @ level_axes(hit).T
    nominal = np.append(places[0], hit.position[2])
    goal = nominal if hit.goal is None else hit.goal
    tried = places[1:]
    return Landing(
        nominal,
        float(slide.yaw[0]),
        np.append(tried.mean(axis=0), hit.position[2]),
        np.cov(tried.T),
        tried,
        goal,
        tolerance,
        float(np.sum(np.linalg.norm(tried - goal[:2], axis=1) <= tolerance)) / samples,
        1.0 - len(tried) / samples,
    )


def slide_after(
    robot: Robot, q: ArrayLike, hit: Hit, speed: float, *, support: Support = "face"
) -> SlidePath:
    """Return how a box, hit level on a table, slides to where `landing` says without any spread.

    Args:
        robot: as `landing`.
        q: as `landing`.
        hit: as `landing`; its spread plays no part.
        speed: as `landing`.
        support: as `landing`.

    Raises:
        InputError: as `landing`.
        InfeasibleError: as `landing`.
    """
    _check(hit, speed)
    drawn = _draw(hit, 0, 0)
    boxes = _boxes(hit, drawn, 0.0, 0.0, support)
    # Hit level with its centre a box does not pitch: it slides at once.
    moved = strike_boxes(
        robot, q, hit, boxes, speed * drawn["speed"], drawn["restitution"]
    ).down.moved
    velocity = turned(moved.velocity, boxes.yaw)
    steps = slide_steps(
        velocity, moved.spin, boxes.size, boxes.friction, yaw=boxes.yaw, support=support
    )
    rows = [(time[0], state[0]) for time, state in steps]
    times, states = np.array([time for time, _ in rows]), np.array([state for _, state in rows])
    axes = level_axes(hit)
    return SlidePath(
        times, states[:, 3:5] @ axes.T, states[:, :2] @ axes.T, states[:, 5] - states[0, 5]
    )


def _check(hit: Hit, speed: float) -> None:
    if abs(hit.direction[2]) > LEVEL:
        raise InputError("direction", hit.direction.tolist(), "a box slides after a level hit only")
    for name in ("restitution", "friction"):
        if getattr(hit, name) is None:
            raise InputError(name, None, "where the object lands depends on it")
    number(speed, "speed", "the contact moves at more than 0 m/s", lambda value: value > 0)


def _boxes(
    hit: Hit, drawn: dict[str, Array], off_centre: float, height: float, support: Support
) -> Boxes:
    """Return a box for every try, the first for the hit without any spread."""
    yaw, offset = drawn["yaw"], drawn["offset"] - off_centre
    size = np.array(POINT_SIZE if hit.size is None else hit.size)
    if hit.size is None:
        yaw, offset = np.zeros_like(yaw), np.zeros_like(offset)
    return Boxes(drawn["mass"], size, yaw, offset, height, drawn["friction"], support)


def _draw(hit: Hit, samples: int, seed: int) -> dict[str, Array]:
    """Return the numbers of every try, the first one without any spread.

    Normal deviates; of what cannot be negative, or above 1, those that would be are drawn in.
    """
    rng, spread = np.random.default_rng(seed), hit.spread or {}
    middle: dict[str, float] = {
        "mass": hit.mass,
        "restitution": hit.restitution or 0.0,
        "friction": hit.friction or 0.0,
        "yaw": hit.yaw,
        "offset": 0.0,
        "speed": 1.0,
    }
    low = {"mass": 0.05 * hit.mass, "restitution": 0.0, "friction": 0.05 * (hit.friction or 0)}
    high = {"restitution": 1.0}
    drawn = {}
    for name, value in middle.items():
        noise = np.append(0.0, rng.standard_normal(samples)) * spread.get(name, 0.0)
        drawn[name] = np.clip(value + noise, low.get(name, -np.inf), high.get(name, np.inf))
    return drawn
