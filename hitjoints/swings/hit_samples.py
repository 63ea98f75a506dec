"""Many configurations that hold the contact at the object, and what each could deliver."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.errors import InfeasibleError
from hitjoints.hitting.velocity_box import velocity_box
from hitjoints.impact.shown_inertia import shown_inertia
from hitjoints.planning.objectives.straight import straight_velocities
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

SAMPLES = 1500
COAST = 0.01
"""m, the way with unchanged joint velocities after the impact."""
IDLE = 0.25
"""Weight of joints that do not move the contact, in the distance of two configurations."""
APART = 0.5
"""rad, the distance of two configurations that are not nearly the same."""
SIDEWAYS = 1e-6
"""Share of the speed that a sample's fastest motion may have sideways."""


class Samples(NamedTuple):
    """Configurations with the contact at the object.

    Attributes:
        q: (N, n) rad.
        J: (N, 3, n) m/rad.
        inertia: (N,) kg.
        lower: (N, n) rad/s, the velocity boxes there.
        upper: (N, n) rad/s, the velocity boxes there.
        qd: (N, n) rad/s, the fastest straight motions within them.
        flux: (N,) m/s, the greatest that can be delivered straight along the direction.
    """

    q: Array
    J: Array
    inertia: Array
    lower: Array
    upper: Array
    qd: Array
    flux: Array


def draw(robot: Robot, hit: Hit, near: Array, seed: int) -> Array:
    """Return configurations (N, n) rad, each in the turn nearest to `near` (n,) rad.

    Raises:
        InfeasibleError: the object is out of reach.
    """
    contact = robot.contact(hit.chosen_contact)
    placed = place_joint(robot, contact, np.tile(hit.position, (SAMPLES, 1)), seed)
    if not placed.solved.any():
        raise InfeasibleError(
            f"unreachable: joint {contact.joint} comes no nearer to the object than "
            f"{placed.error.min():.3g} m",
            {"joint": contact.joint, "nearest": float(placed.error.min())},
        )
    return folded(robot, placed.q[placed.solved], near)


def folded(robot: Robot, q: Array, near: Array) -> Array:
    """Return configurations (N, n) rad in the turns of revolute joints nearest to `near` (n,)."""
    turn = 2.0 * np.pi
    revolute = np.array([not name.startswith("JointModelP") for name in _kinds(robot)])
    with np.errstate(invalid="ignore"):
        most = np.floor((robot.upper - q) / turn)
        least = np.ceil((robot.lower - q) / turn)
    turns = np.clip(np.round((near - q) / turn), least, most)
    return np.where(revolute, np.clip(q + turn * turns, robot.lower, robot.upper), q)


def _kinds(robot: Robot) -> list[str]:
    return [robot.model.joints[i].shortname() for i in range(1, robot.n + 1)]


def measured(robot: Robot, hit: Hit, limits: DriveLimits, q: Array) -> Samples:
    """Return what configurations (N, n) rad can deliver: a linear program each, all at once."""
    contact, h = robot.contact(hit.chosen_contact), hit.direction
    seen = kernel_for(robot, (contact,), ("inertia", "jacobian"))(q, h)
    J, inertia = np.ascontiguousarray(seen["jacobian"][0]), np.array(seen["inertia"][0])
    if not hit.setting.drives.rigid:
        inertia = shown_inertia(robot, q, contact, hit)
    share = inertia / (inertia + hit.mass)
    share = np.where(np.isfinite(share), share, 0.0)
    ends = robot.lower, robot.upper
    if hit.flux is None:
        first = velocity_box(limits, q, *ends)
        speed = np.maximum(_fastest(J, h, *first)[1], 1e-6)
    else:
        speed = hit.flux / np.maximum(share, 1e-9)
    lower, upper = velocity_box(limits, q, *ends, COAST / speed[:, None])
    qd, speed = _fastest(J, h, lower, upper)
    return Samples(q, J, inertia, lower, upper, qd, share * speed)


def joined(one: Samples, other: Samples) -> Samples:
    """Return all of two."""
    return Samples(*(np.concatenate(both) for both in zip(one, other, strict=True)))


def _fastest(J: Array, h: Array, lower: Array, upper: Array) -> tuple[Array, Array]:
    """Return the fastest straight motions (N, n) rad/s in boxes (N, n), and their speeds (N,)."""
    basis = np.linalg.svd(h[None, :])[2][1:]
    pull, across = h @ J, basis @ J
    qd = straight_velocities(pull, across, lower, upper)
    speed = (pull * qd).sum(axis=1)
    sideways = np.linalg.norm((across @ qd[:, :, None])[:, :, 0], axis=1)
    straight = (speed > 0) & (sideways <= SIDEWAYS * np.abs(speed) + 1e-9)
    return qd, np.where(straight, speed, 0.0)


def spread_out(
    robot: Robot, hit: Hit, samples: Samples, chosen: NDArray[np.intp], start: Array, near: int
) -> Iterator[int]:
    """Yield the chosen rows: some near the start, then the farthest from all before.

    Diverse configurations matter: of near ones mostly all fail, or none.

    Args:
        robot: the arm and the hit.
        hit: the arm and the hit.
        samples: all.
        chosen: (M,) rows.
        start: (n,) rad.
        near: so many of those nearest to the start come first, `APART` from each other.
    """
    contact = robot.contact(hit.chosen_contact)
    moving = contact.joint if any(contact.offset) else contact.joint - 1
    weights = np.where(np.arange(robot.n) < moving, 1.0, IDLE)
    q = samples.q[chosen] * weights
    far = np.abs(q - start * weights).max(axis=1)
    distance = np.full(len(chosen), np.inf)
    for i in range(len(chosen)):
        apart = np.where(distance >= APART**2, far, np.inf)
        close = i < near and bool(np.isfinite(apart).any())
        now = int(np.argmin(apart)) if close else int(np.argmax(distance))
        yield int(chosen[now])
        distance = np.minimum(distance, ((q - q[now]) ** 2).sum(axis=1))
        distance[now] = -1.0
