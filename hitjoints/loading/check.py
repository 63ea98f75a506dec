"""Judge the numbers of a robot description: can a real arm have them, and what do they spoil?"""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.model.robot import Contact, Robot
from hitjoints.tolerances import MOBILITY_FLOOR

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.arm import Arm, Link

SAMPLES = 100  # configurations a wrong inertia's effect is measured on
THICKNESS = 0.1  # of a link, as a share of the arm's reach: joint origins tell only the length
ROUND_OFF = 1e-9  # relative slack for inertias written with a few digits


@dataclass(frozen=True)
class Issue:
    """One finding.

    Attributes:
        severity: "error" when the inertias computed from the model are wrong, "warning" when they
            may be, "note" when a feature will be missing.
        link: link or joint it is about.
        problem: what is wrong, with the numbers.
        effect: what that does.
    """

    severity: str
    link: str
    problem: str
    effect: str

    def __str__(self) -> str:
        return f"{self.link}: {self.problem}; {self.effect}"

    def as_dict(self) -> dict[str, str]:
        """Return the fields by name."""
        return asdict(self)


def check_arm(arm: Arm, robot: Robot) -> list[Issue]:
    """Check link inertias and joint limits; the gravest findings first."""
    issues = [
        *_check_links(arm, robot),
        *_check_mass_matrix(robot),
        *_check_limits(robot),
    ]
    return sorted(issues, key=lambda issue: ("error", "warning", "note").index(issue.severity))


def _check_links(arm: Arm, robot: Robot) -> list[Issue]:
    issues = []
    reach = sum(link.size for link in arm.links if link.moving)
    for link in arm.links:
        if _frame(link, robot).parentJoint == 0:
            continue  # the base does not move: its inertia plays no part
        problem, severity = _inertia_problem(link, reach)
        if problem:
            effect = _effect(robot, link) if severity == "error" else "it deserves a second look"
            issues.append(Issue(severity, link.name, problem, effect))
    return issues


def _frame(link: Link, robot: Robot) -> Any:
    import pinocchio as pin

    # A joint may have the same name as a link.
    return robot.model.frames[robot.model.getFrameId(link.name, pin.FrameType.BODY)]


def _inertia_problem(link: Link, reach: float) -> tuple[str, str]:  # noqa: PLR0911
    """Return the worst thing wrong with a link's inertia, and how grave it is."""
    small, middle, large = moments = np.linalg.eigvalsh(link.inertia)
    slack = ROUND_OFF * abs(moments).max(initial=0.0)
    shown = f"principal moments {small:.3g}, {middle:.3g}, {large:.3g} kg m^2"
    if link.mass == 0 and large > slack:
        return f"zero mass with {shown}", "error"
    if link.mass == 0:
        return ("zero mass", "warning") if link.moving else ("", "")
    if large == 0 and small == 0:
        return f"zero inertia tensor with a mass of {link.mass:g} kg", "warning"
    if small < -slack or (link.moving and small <= 0):
        return f"inertia not positive definite: {shown}", "error"
    gyration = float(np.sqrt(large / link.mass))
    if gyration > max(reach, link.size):
        return (
            f"radius of gyration {gyration:.3g} m from a mass of {link.mass:g} kg, "
            f"longer than the whole arm ({reach:.3g} m)",
            "error",
        )
    if small + middle < large * (1 - 1e-6):
        return f"triangle inequality violated: {shown}, no body has these", "error"
    size = link.size + THICKNESS * reach
    if gyration > size:
        return (
            f"radius of gyration {gyration:.3g} m is out of proportion to a link "
            f"of about {size:.2g} m",
            "warning",
        )
    return "", ""


def _effect(robot: Robot, link: Link) -> str:
    """Measure how the link's rotational inertia scales the inertia at the joint that carries it.

    Near the base that joint's origin cannot move: then the flange shows the effect.
    """
    import pinocchio as pin

    frame = _frame(link, robot)
    joint = frame.parentJoint
    without = pin.Model(robot.model)
    # Set by parts: the constructor refuses what taking a wrong tensor away may leave.
    body = pin.Inertia(robot.model.inertias[joint])
    body.inertia -= frame.placement.rotation @ link.inertia @ frame.placement.rotation.T
    without.inertias[joint] = body
    for contact, place in ((Contact(joint), f"joint {joint}"), (robot.flange, "the flange")):
        ratios = _inertia_ratios(robot, without, contact)
        if ratios.size:
            return (
                f"it multiplies the directional inertia at {place} by {np.median(ratios):.2g} "
                f"in the median (up to {ratios.max():.2g})"
            )
    return "the directional inertia is not defined without it"


def _inertia_ratios(robot: Robot, other: Any, contact: Contact) -> NDArray[np.float64]:
    from hitjoints.dynamics.inertia import mobility

    rng = np.random.default_rng(0)
    low = np.where(np.isfinite(robot.lower), robot.lower, -np.pi)
    high = np.where(np.isfinite(robot.upper), robot.upper, np.pi)
    data = other.createData()
    ratios = []
    for q in rng.uniform(low, high, (SAMPLES, robot.n)):
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        try:
            given = mobility(robot.model, robot.data, q, contact, h)
            clean = mobility(other, data, q, contact, h)
        except ModelError:
            continue
        if min(given, clean) >= MOBILITY_FLOOR:
            ratios.append(clean / given)
    return np.array(ratios)


def _check_mass_matrix(robot: Robot) -> list[Issue]:
    from hitjoints.dynamics.inertia import factor_mass_matrix

    try:
        factor_mass_matrix(robot.model, robot.data, robot.home)
    except ModelError:
        # The factorisation runs from the tip to the base: the last bad pivot is the cause.
        bad = np.flatnonzero(~(robot.data.D > 0))[-1]
        problem = "it carries no inertia, or a negative one"
        effect = "the mass matrix is not positive definite: no directional inertia is defined"
        return [Issue("error", robot.joint_names[bad], problem, effect)]
    return []


def _check_limits(robot: Robot) -> list[Issue]:
    issues = []
    for i, name in enumerate(robot.joint_names):
        if robot.velocity_upper[i] == 0:
            effect = "the joint counts as locked and adds no hitting speed"
            issues.append(Issue("warning", name, "zero or missing velocity limit", effect))
        if robot.effort[i] == 0:
            effect = "torque limits cannot be applied"
            issues.append(Issue("note", name, "zero or missing effort limit", effect))
        if robot.lower[i] == robot.upper[i]:
            effect = "the joint cannot move"
            issues.append(Issue("warning", name, "equal lower and upper position limits", effect))
    return issues


def check_shapes(robot: Robot) -> list[Issue]:
    """Check that every collision shape can be read; this reads the meshes too."""
    effect = "clearance is not known"
    return [
        Issue("warning", link, f"a collision shape cannot be read: {reason}", effect)
        for link, reason in robot.shape_faults
    ]
