"""Compare what Pinocchio made of a description with what was read, number by number."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.model.tree import MOVING, rotation, turn_about

if TYPE_CHECKING:
    from hitjoints.model.arm import Arm
    from hitjoints.model.tree import Connection
    from hitjoints.types import Array

TOLERANCE = 1e-9  # relative: far above round-off, far below any misreading
MOMENTS = {"mass": slice(1), "mass centre": slice(1, 4), "tensor": slice(4, 10)}
PROBE = 0.3  # rad or m, times the number of the joint: where placements and axes are compared


def compare_model(model: Any, arm: Arm, source: str) -> None:
    """Compare limits, placements, axes, masses, mass centres and tensors of a Pinocchio model.

    Args:
        model: pin.Model, before anything but the description went into it.
        arm: what was read.
        source: what to call the description in messages.

    Raises:
        ModelError: a number differs; the message says which, and both values.
    """
    import pinocchio as pin

    _compare_limits(model, arm, source)
    q: Array = PROBE * np.arange(1.0, len(arm.joints) + 1)
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    places, carriers = _placed(arm, q)
    for number, name in enumerate(arm.joints, start=1):
        place = places[arm.tree.joints[name].child]
        found = data.oMi[number].homogeneous
        _same(source, f"joint {name}: its place", found, place, 1.0 + np.abs(place).max())
    sums = {number: np.zeros(10) for number in range(1, len(arm.joints) + 1)}
    for link in arm.links:
        if number := carriers[link.name]:
            if link.mass < 0:
                # Pinocchio's mass centre of such a body is no number at all.
                raise ModelError(source, f"link {link.name}: negative mass {link.mass:g} kg")
            place = places[link.name]
            com, turn = place[:3, :3] @ link.com + place[:3, 3], place[:3, :3]
            sums[number] += _moments(link.mass, com, turn @ link.inertia @ turn.T)
    for number, expected in sums.items():
        name, body = arm.joints[number - 1], model.inertias[number]
        place = data.oMi[number]
        found = _moments(
            body.mass, place.act(body.lever), place.rotation @ body.inertia @ place.rotation.T
        )
        for what, part in MOMENTS.items():
            scale = np.abs(expected[part]).max() + np.abs(expected[0])
            carried = f"joint {name}: the {what} it carries"
            _same(source, carried, found[part], expected[part], scale)


def _same(source: str, what: str, found: Any, expected: Any, scale: float) -> None:
    if not np.abs(np.subtract(found, expected)).max() <= TOLERANCE * scale:
        values = f"{np.ravel(found).tolist()} and not {np.ravel(expected).tolist()}"
        raise ModelError(source, f"{what} is read by Pinocchio as {values}")


def _compare_limits(model: Any, arm: Arm, source: str) -> None:
    sides = {
        "lower": model.lowerPositionLimit,
        "upper": model.upperPositionLimit,
        "velocity": model.upperVelocityLimit,
        "effort": model.upperEffortLimit,
    }
    for i, name in enumerate(arm.joints):
        for side, values in sides.items():
            expected = getattr(arm.tree.joints[name], side)
            if side in ("lower", "upper") and name in arm.continuous:
                continue
            _same(source, f"joint {name}: {side} limit", values[i], expected, abs(expected))


def _placed(arm: Arm, q: Array) -> tuple[dict[str, Array], dict[str, int]]:
    """Return every link's place (4, 4) and the number of the joint that carries it, 0 for none."""
    numbers = {name: number for number, name in enumerate(arm.joints, start=1)}
    places, carriers = {arm.tree.root: np.eye(4)}, {arm.tree.root: 0}
    hanging: dict[str, list[Connection]] = {}
    for joint in arm.tree.joints.values():
        hanging.setdefault(joint.parent, []).append(joint)
    links = [arm.tree.root]
    for link in links:
        for joint in hanging.get(link, []):
            number = numbers.get(joint.name, 0)
            place = places[link] @ _frame(rotation(joint.rpy), joint.xyz)
            if number:
                place = place @ _motion(joint, q[number - 1])
            places[joint.child], carriers[joint.child] = place, number or carriers[link]
            links.append(joint.child)
    return places, carriers


def _frame(turn: Array, at: Array) -> Array:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = turn, at
    return frame


def _motion(joint: Connection, q: float) -> Array:
    if joint.kind == MOVING[-1]:
        return _frame(np.eye(3), q * joint.axis / np.linalg.norm(joint.axis))
    return _frame(turn_about(joint.axis, q), np.zeros(3))


def _moments(mass: float, com: Array, tensor: Array) -> Array:
    """Return mass, first and second moments about the world's origin, (10,): they add up."""
    about = tensor + mass * (com @ com * np.eye(3) - np.outer(com, com))
    return np.array([mass, *(mass * com), *about[np.triu_indices(3)]])
