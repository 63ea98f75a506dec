"""What each joint shows in a hit, by how long the contact lasts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.datasets.describe import described
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit import Hit
from hitjoints.hit_setting import setting_of
from hitjoints.impact.elastic import elastic_impact
from hitjoints.impact.inertia_models import INERTIA_MODELS, impact_inertia
from hitjoints.quantities import hitting_speed, place_joint
from hitjoints.vectors import points, positive_mass, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.model.robot import Contact, Robot

VARIABLES = ("equivalent", "shown", "object_speed", "robot_speed", "contact_time")


class Crossing(NamedTuple):
    """A contact time (s) at which two joints are equal, and in what: a variable of the sweep."""

    time: float
    value: float
    joints: tuple[int, int]
    variable: str


def sweep_contact_time(  # noqa: PLR0913
    robot: Robot,
    position: ArrayLike,
    direction: ArrayLike,
    mass: float,
    times: ArrayLike,
    *,
    restitution: float = 0.5,
    joints: Sequence[Contact | int] | None = None,
    start: ArrayLike | None = None,
    stiffness: ArrayLike | None = None,
    rotor_inertia: ArrayLike | None = None,
    seed: int = 0,
) -> Dataset:
    """Place each joint at a point and hit with contacts of every length, at its greatest speed.

    Args:
        robot: the arm.
        position: (3,) m, where the object is.
        direction: (3,), the hitting direction.
        mass: kg, of the object.
        times: (T,) s, how long the rigid pair touches.
        restitution: eps, from 0 to 1.
        joints: hitting joints or contacts; the robot's own when not given.
        start: (n,) rad, from which each joint is placed; the robot's home when not given.
        stiffness: of the joints, see `elastic_impact`.
        rotor_inertia: likewise.
        seed: of the inverse kinematics' random restarts.

    Returns:
        A data set over (joint, time): equivalent, shown, object_speed, robot_speed, contact_time;
        over joint: rigid, rotor, composite (kg), straight_speed (m/s), q. A joint that does not
        reach the object, or cannot move along the direction, is left out.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: no joint reaches the position and moves along the direction.
        ModelError: the rotor inertia is not known.
    """
    target, h = points(position, "position").reshape(3), unit(direction)
    mass = positive_mass(mass)
    spans = np.atleast_1d(np.asarray(times, dtype=float))
    if spans.ndim != 1 or not (np.isfinite(spans).all() and (spans > 0).all()):
        raise InputError("times", times, "contact times above 0 s")
    common = robot.within_limits(robot.home if start is None else start, "start")
    rows: list[dict[str, Any]] = []
    for contact in robot.contacts(joints):
        placed = place_joint(robot, contact, target, seed, start=common)
        q = placed.q[0]
        speed = hitting_speed(robot, q, contact, h, straight=True) if placed.solved[0] else 0.0
        if not speed > 0:
            continue
        hits = [
            elastic_impact(
                robot, q, contact, h, mass, speed, restitution, float(span), stiffness,
                rotor_inertia=rotor_inertia,
            ).as_dict()
            for span in spans
        ]  # fmt: skip
        row: dict[str, Any] = {"joint": contact.joint, "q": q, "straight_speed": speed}
        row |= {name: [_or_nan(hit[name]) for hit in hits] for name in VARIABLES}
        for model in INERTIA_MODELS:
            row[model] = impact_inertia(robot, q, contact, h, model, rotor_inertia=rotor_inertia)
        rows.append(row)
    if not rows:
        raise InfeasibleError("no joint reaches the position and moves along the direction")
    setting = setting_of(robot, robot.contacts(joints))
    setting = replace(setting, q0=tuple(common.tolist()), seed=seed)
    asked = Hit(None, target, h, mass, restitution=restitution, setting=setting)
    return _assembled(robot, rows, spans, asked)


def crossings(swept: Dataset, variable: str = "equivalent") -> list[Crossing]:
    """Return where two joints' lines cross, by contact time."""
    found = []
    log = np.log(swept.time.values)
    for one, other in combinations(swept.joint.values.tolist(), 2):
        first = swept[variable].sel(joint=one).values
        apart = first - swept[variable].sel(joint=other).values
        for i in np.flatnonzero(apart[:-1] * apart[1:] < 0):
            share = apart[i] / (apart[i] - apart[i + 1])
            time = float(np.exp(log[i] + share * (log[i + 1] - log[i])))
            value = float(first[i] + share * (first[i + 1] - first[i]))
            found.append(Crossing(time, value, (one, other), variable))
    return sorted(found)


def _or_nan(value: float | None) -> float:
    return np.nan if value is None else value


def _assembled(
    robot: Robot,
    rows: list[dict[str, Any]],
    spans: Any,
    asked: Hit,
) -> Dataset:
    import xarray as xr

    columns: dict[str, Any] = {
        name: (("joint", "time"), np.array([row[name] for row in rows])) for name in VARIABLES
    }
    for name in (*INERTIA_MODELS, "straight_speed"):
        columns[name] = "joint", np.array([row[name] for row in rows])
    columns["q"] = ("joint", "axis"), np.stack([row["q"] for row in rows])
    coordinates = {
        "joint": [row["joint"] for row in rows],
        "time": spans,
        "axis": np.arange(1, robot.n + 1),
    }
    told = {
        "position": asked.position.tolist(),
        "direction": asked.direction.tolist(),
        "mass": asked.mass,
        "restitution": asked.restitution,
        "hit": asked.text,
    }
    return described(xr.Dataset(columns, coords=coordinates), robot, **told)
