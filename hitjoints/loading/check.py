"""Judge the numbers of a robot description: can a real arm have them, and what do they spoil?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.loading.tensors import TensorFault, effect_of, link_frame, tensor_fault

if TYPE_CHECKING:
    from hitjoints.model.arm import Arm, Link
    from hitjoints.model.robot import Robot

PLACEHOLDERS = 3  # moving links with the same mass and tensor that are no coincidence
MOST_TOLD = 12  # held joints
SEVERITIES = ("error", "warning", "note")


@dataclass(frozen=True)
class Issue:
    """One finding.

    Attributes:
        severity: "error" when the inertias computed from the model are wrong by more than a
            twentieth, "warning" when they may be or when a quantity will be zero, "note" when a
            feature will be missing or an error does not matter.
        link: link or joint it is about; several, separated by commas, if they are judged together.
        problem: what is wrong, with the numbers.
        effect: what that does.
        at_load: whether it is told at load too.
    """

    severity: str
    link: str
    problem: str
    effect: str
    at_load: bool = False

    def __str__(self) -> str:
        return f"{self.link}: {self.problem}; {self.effect}"

    def as_dict(self) -> dict[str, str]:
        """Return what is told by name."""
        return {
            "severity": self.severity,
            "link": self.link,
            "problem": self.problem,
            "effect": self.effect,
        }


def check_arm(arm: Arm, robot: Robot, doubts: bool = True) -> list[Issue]:
    """Check link inertias, joint limits and what is missing; the gravest findings first.

    Args:
        arm: what the robot was made of.
        robot: the robot.
        doubts: judge what is possible but unlikely too, which loading has no time for.
    """
    issues = [
        *(_check_links(arm, robot, doubts) if robot.has_mass else _no_mass()),
        *_check_limits(robot),
        *_check_held(arm),
        *_check_drives(robot),
    ]
    return sorted(issues, key=lambda issue: SEVERITIES.index(issue.severity))


def _no_mass() -> list[Issue]:
    effect = "kinematics and speeds are known, inertias, fluxes and motions are not"
    return [Issue("error", "every link", "no link has mass", effect, at_load=True)]


def _check_links(arm: Arm, robot: Robot, doubts: bool) -> list[Issue]:
    sizes = {link.name: link.size for link in arm.links}
    way = [joint for joint in arm.tree.above(arm.tip) if joint.parent != arm.tree.root]
    reach = sum(float(np.linalg.norm(joint.xyz)) for joint in way) + sizes[arm.tip]
    # The base does not move: its inertia plays no part.
    links = [link for link in arm.links if link_frame(link, robot).parentJoint]
    faults = [fault for link in links if (fault := tensor_fault(link, reach)) is not None]
    missing = [
        Issue("warning", fault.link.name, fault.problem, "it deserves a second look")
        for fault in faults
        if fault.possible is None
    ]
    wrong = [fault for fault in faults if fault.possible is not None]
    return [
        *_judge([fault for fault in wrong if not fault.doubtful], robot, "error"),
        *_check_mass_matrix(robot),
        *_judge([fault for fault in wrong if fault.doubtful and doubts], robot, "warning"),
        *missing,
        *_check_placeholders(links),
    ]


def _judge(faults: Sequence[TensorFault], robot: Robot, severity: str) -> list[Issue]:
    """Judge wrong tensors by what they do: each alone, and together those that do little."""
    issues, small = [], []
    loud = severity == "error"
    for fault in faults:
        effect = effect_of([fault], robot)
        if effect is None:
            without = "the directional inertia is not defined without it"
            issues.append(Issue(severity, fault.link.name, fault.problem, without, loud))
        elif effect.matters:
            words = f"it multiplies {effect}"
            issues.append(Issue(severity, fault.link.name, fault.problem, words, loud))
        else:
            small.append((fault, f"it multiplies {effect}: that does not matter"))
    together = effect_of([fault for fault, _ in small], robot) if len(small) > 1 else None
    if together is None or not together.matters:
        return issues + [Issue("note", f.link.name, f.problem, words) for f, words in small]
    names = ", ".join(fault.link.name for fault, _ in small)
    kind = "doubtful" if small[0][0].doubtful else "impossible"
    problem = f"{len(small)} {kind} tensors, the first: {small[0][0].problem}"
    words = f"together they multiply {together}"
    return [*issues, Issue(severity, names, problem, words, loud)]


def _check_placeholders(links: Sequence[Link]) -> list[Issue]:
    alike: dict[tuple[float, ...], list[str]] = {}
    for link in links:
        if link.moving and link.mass > 0:
            key = (link.mass, *np.round(np.linalg.eigvalsh(link.inertia), 12))
            alike.setdefault(key, []).append(link.name)
    return [
        Issue(
            "warning",
            ", ".join(names),
            f"{len(names)} links have the same mass {key[0]:g} kg and tensor: placeholders",
            "the inertias computed from them are guesses",
            at_load=True,
        )
        for key, names in alike.items()
        if len(names) >= PLACEHOLDERS
    ]


def _check_mass_matrix(robot: Robot) -> list[Issue]:
    from hitjoints.dynamics.inertia import factor_mass_matrix

    try:
        factor_mass_matrix(robot.model, robot.data, robot.home)
    except ModelError:
        # The factorisation runs from the tip to the base: the last bad pivot is the cause.
        bad = np.flatnonzero(~(robot.data.D > 0))[-1]
        problem = "it carries no inertia, or a negative one"
        effect = "the mass matrix is not positive definite: no directional inertia is defined"
        return [Issue("error", robot.joint_names[bad], problem, effect, at_load=True)]
    return []


def _check_limits(robot: Robot) -> list[Issue]:
    issues = []
    names = np.array(robot.joint_names)
    if still := ", ".join(names[robot.velocity_upper == 0]):
        effect = "a joint without one counts as locked and adds no hitting speed; a TOML may give "
        effect += "velocity = [...] (rad/s)"
        issues.append(Issue("warning", still, "zero or missing velocity limit", effect, True))
    for i in np.flatnonzero(robot.lower == robot.upper):
        effect = "the joint cannot move"
        issues.append(Issue("warning", names[i], "equal lower and upper position limits", effect))
    if weak := ", ".join(names[robot.effort == 0]):
        effect = "torque limits cannot be applied"
        issues.append(Issue("note", weak, "zero or missing effort limit", effect))
    return issues


def _check_held(arm: Arm) -> list[Issue]:
    if not arm.held:
        return []
    told = [f"{name}={value:.4g}" for name, value in arm.held.items()]
    if len(told) > MOST_TOLD:
        told[MOST_TOLD:] = [f"{len(told) - MOST_TOLD} more"]
    names = ", ".join(told)
    problem = f"held still, off the way to the tip {arm.tip}"
    return [Issue("note", names, problem, "what hangs on it rides along")]


def _check_drives(robot: Robot) -> list[Issue]:
    missing = {
        "acceleration limits": (robot.acceleration, "how long speeding up takes is not known"),
        "rotor inertias": (robot.rotor_inertia, "what the motors add to an impact is not known"),
    }
    return [
        Issue("note", "every joint", f"no {what}", effect)
        for what, (values, effect) in missing.items()
        if values is None and not robot.model.armature.any()
    ]


def check_shapes(robot: Robot) -> list[Issue]:
    """Check that every collision shape can be read; this reads the meshes too."""
    effect = "clearance is not known"
    return [
        Issue("warning", link, f"a collision shape cannot be read: {reason}", effect)
        for link, reason in robot.shape_faults
    ]
