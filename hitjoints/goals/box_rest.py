"""Where one hit box comes to rest: told beforehand, or found."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.goals.box_hit import Boxes, Departure, hit_boxes
from hitjoints.goals.leaning import turned
from hitjoints.goals.sliding import Rest, Support, slide_to_rest
from hitjoints.impact.shown_inertia import shown_mobility
from hitjoints.told import Told

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False, repr=False)
class BoxRest(Told):
    """How a box left a hit, and where it came to rest.

    Attributes:
        place: (3,) m, the place of the hit, moved as the box's centre was.
        distance: m, of the centre, straight.
        direction: rad, of that way against the hitting direction, to the left.
        yaw: rad, turned on the way, to the left.
        speed: m/s, of the centre after the hit.
        spin: rad/s, about the vertical after the hit.
        tipped: it fell over; the place is where it did.
    """

    place: Array
    distance: float
    direction: float
    yaw: float
    speed: float
    spin: float
    tipped: bool = False

    def miss(self, other: BoxRest) -> float:
        """Return the distance (m) to where another rests."""
        return float(np.linalg.norm(self.place - other.place))

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name, as JSON knows them."""
        return vars(self) | {"place": self.place.tolist()}


def rest_at(
    hit: Hit,
    displacement: Array,
    *,
    yaw: float,
    speed: float,
    spin: float,
    tipped: bool = False,
) -> BoxRest:
    """Return the rest of a box whose centre went a way.

    Args:
        hit: that moved it.
        displacement: (2,) m, of the centre, robot base frame.
        yaw: see `BoxRest`.
        speed: see `BoxRest`.
        spin: see `BoxRest`.
        tipped: see `BoxRest`.
    """
    along, aside = displacement @ level_axes(hit)
    return BoxRest(
        hit.position + np.append(displacement, 0.0),
        float(np.hypot(*displacement)),
        math.atan2(aside, along),
        yaw,
        speed,
        spin,
        tipped,
    )


def predict_rest(
    robot: Robot,
    q: ArrayLike,
    hit: Hit,
    speed: float,
    *,
    off_centre: float = 0.0,
    height: float = 0.0,
    support: Support = "face",
) -> BoxRest:
    """Predict where a box comes to rest that is hit level, on a table; nothing is spread.

    Args:
        robot: the arm.
        q: (n,) rad, at the impact.
        hit: with size, restitution and friction.
        speed: m/s, of the contact along the hit's direction.
        off_centre: m, to the left from the line of the hit to the box's centre.
        height: m, of the contact above the box's centre of mass.
        support: what carries the box, its "face" or its four "corners".

    Raises:
        InfeasibleError: the box would be missed, tip, or slide on its edge.
    """
    assert hit.size is not None
    one = np.ones(1)
    boxes = Boxes(
        hit.mass * one, hit.size, hit.yaw * one, -off_centre * one, height,
        (hit.friction or 0.0) * one, support,
    )  # fmt: skip
    restitution = (hit.restitution or 0.0) * one
    left, slid = send_boxes(robot, q, hit, boxes, speed * one, restitution)
    return rest_at(
        hit,
        level_axes(hit) @ slid.displacement[0],
        yaw=float(slid.yaw[0]),
        speed=float(np.hypot(*left.velocity[0])),
        spin=float(left.spin[0]),
    )


def send_boxes(
    robot: Robot,
    q: ArrayLike,
    hit: Hit,
    boxes: Boxes,
    speed: Array,
    restitution: Array,
) -> tuple[Departure, Rest]:
    """Hit boxes with an arm, as `strike_boxes`, and let them slide.

    Args:
        robot: as `strike_boxes`.
        q: as `strike_boxes`.
        hit: as `strike_boxes`.
        boxes: as `strike_boxes`.
        speed: as `strike_boxes`.
        restitution: as `strike_boxes`.

    Returns:
        How they leave and how they rest, along the hitting direction and to its left.

    Raises:
        InfeasibleError: as `strike_boxes`.
    """
    left = strike_boxes(robot, q, hit, boxes, speed, restitution)
    down = left.down
    slid = slide_to_rest(
        turned(down.moved.velocity, boxes.yaw), down.moved.spin, boxes.size, boxes.friction,
        yaw=boxes.yaw + down.yaw, support=boxes.support,
    )  # fmt: skip
    way = slid.displacement + turned(down.way, boxes.yaw)
    return left, replace(slid, displacement=way, yaw=slid.yaw + down.yaw)


def strike_boxes(
    robot: Robot,
    q: ArrayLike,
    hit: Hit,
    boxes: Boxes,
    speed: Array,
    restitution: Array,
) -> Departure:
    """Hit boxes with an arm, each as a hit has it but for what is given.

    Args:
        robot: the arm.
        q: (n,) rad, at the impact.
        hit: contact and direction.
        boxes: N of them.
        speed: (N,) m/s, of the contact along the direction.
        restitution: (N,) eps.

    Raises:
        InfeasibleError: a box would be missed, tip, or slide on its edge.
    """
    contact = robot.contact(hit.chosen_contact)
    mobility = shown_mobility(robot, robot.one_configuration(q), contact, hit)[:2, :2]
    normal = np.column_stack((np.cos(boxes.yaw), np.sin(boxes.yaw))) @ level_axes(hit).T
    felt = 1 / np.einsum("na,ab,nb->n", normal, mobility, normal)
    return hit_boxes(boxes, felt, speed, restitution)


def level_axes(hit: Hit) -> Array:
    """Return a level hitting direction and its left, (2, 2), as columns."""
    h = hit.direction[:2] / np.linalg.norm(hit.direction[:2])
    return np.column_stack((h, (-h[1], h[0])))
