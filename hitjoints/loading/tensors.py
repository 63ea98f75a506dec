"""Masses and tensors that no body can have, and what they do to the directional inertia."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.model.robot import Contact, Robot
from hitjoints.tolerances import moves

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.model.arm import Link

SAMPLES = 100  # configurations a wrong inertia's effect is measured on
THICKNESS = 0.1  # of a link, as a share of the arm's reach: joint origins tell only the length
ROUND_OFF = 1e-9  # relative slack for inertias written with a few digits
TRIANGLE = 1e-6  # the same for the triangle inequality
MATTERS = 1.05  # a factor on an inertia that is worth an error


@dataclass(frozen=True)
class TensorFault:
    """What is wrong with a link's mass and tensor.

    Attributes:
        link: the link.
        problem: in words, with the numbers.
        possible: (3, 3) kg m^2, the tensor nearest to it that a body can have; None where a mass
            or tensor is missing.
        doubtful: a body of unlikely shape could have it.
    """

    link: Link
    problem: str
    possible: NDArray[np.float64] | None
    doubtful: bool = False


def tensor_fault(link: Link, reach: float) -> TensorFault | None:  # noqa: PLR0911
    """Return the worst thing wrong with a link's inertia.

    Args:
        link: the link.
        reach: m, of the whole arm.
    """
    small, middle, large = moments = np.linalg.eigvalsh(link.inertia)
    slack = ROUND_OFF * abs(moments).max(initial=0.0)
    shown = f"principal moments {small:.3g}, {middle:.3g}, {large:.3g} kg m^2"
    none = np.zeros((3, 3))
    if link.mass == 0 and large > slack:
        return TensorFault(link, f"zero mass with {shown}", none)
    if link.mass == 0:
        return TensorFault(link, "zero mass", None) if link.moving else None
    if large == 0 and small == 0:
        return TensorFault(link, f"zero inertia tensor with a mass of {link.mass:g} kg", None)
    if small < -slack or (link.moving and small <= 0):
        problem = f"inertia not positive definite: {shown}"
        return TensorFault(link, problem, nearest_tensor(link.inertia))
    gyration = float(np.sqrt(large / link.mass))
    radius = f"radius of gyration {gyration:.3g} m"
    if gyration > max(reach, link.size):
        whole = f"longer than the whole arm ({reach:.3g} m)"
        return TensorFault(link, f"{radius} from a mass of {link.mass:g} kg, {whole}", none)
    if small + middle < large * (1 - TRIANGLE):
        problem = f"triangle inequality violated: {shown}, no body has these"
        return TensorFault(link, problem, nearest_tensor(link.inertia))
    size = link.size + THICKNESS * reach
    if gyration > size:
        problem = f"{radius} is out of proportion to a link of about {size:.2g} m"
        return TensorFault(link, problem, link.inertia * (size / gyration) ** 2, doubtful=True)
    return None


def nearest_tensor(inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a tensor (3, 3) kg m^2 that a body can have: its second moments are not negative."""
    moments, axes = np.linalg.eigh(inertia)
    spread = np.maximum(moments.sum() / 2 - moments, 0.0)
    return np.asarray(axes @ np.diag(spread.sum() - spread) @ axes.T)


@dataclass(frozen=True)
class Effect:
    """By what wrong tensors multiply the directional inertia.

    Attributes:
        place: of the contact, in words.
        median: of the factors over random configurations and directions.
        greatest: of the factors over random configurations and directions.
    """

    place: str
    median: float
    greatest: float

    @property
    def matters(self) -> bool:
        """Whether an inertia changes by more than a twentieth in the median."""
        return not 1 / MATTERS <= self.median <= MATTERS

    def __str__(self) -> str:
        return (
            f"the directional inertia at {self.place} by {self.median:.2g} "
            f"in the median (up to {self.greatest:.2g})"
        )


def effect_of(faults: Sequence[TensorFault], robot: Robot) -> Effect | None:
    """Measure what some wrong tensors do together, against the nearest possible ones.

    It is measured at the joint that carries the last of them, or at the flange where it does more,
    or where the joint's origin cannot move. None: without them no directional inertia is defined.

    Args:
        faults: those with a possible tensor.
        robot: the arm as it is described.
    """
    import pinocchio as pin

    mended = pin.Model(robot.model)
    joint = 0
    for fault in faults:
        frame = link_frame(fault.link, robot)
        joint = max(joint, frame.parentJoint)
        turn = frame.placement.rotation
        # Set by parts: the constructor refuses what taking a wrong tensor away may leave.
        body = pin.Inertia(mended.inertias[frame.parentJoint])
        assert fault.possible is not None
        left = body.inertia - turn @ (fault.link.inertia - fault.possible) @ turn.T
        body.inertia = (left + left.T) / 2
        mended.inertias[frame.parentJoint] = body
    found = []
    for contact, place in ((Contact(joint), f"joint {joint}"), (robot.flange, "the flange")):
        ratios = _inertia_ratios(robot, mended, contact)
        if ratios.size:
            found.append(Effect(place, float(np.median(ratios)), float(ratios.max())))
    return next((effect for effect in found if effect.matters), found[0] if found else None)


def link_frame(link: Link, robot: Robot) -> Any:
    """Return the Pinocchio frame of a link."""
    import pinocchio as pin

    # A joint may have the same name as a link.
    return robot.model.frames[robot.model.getFrameId(link.name, pin.FrameType.BODY)]


def _inertia_ratios(robot: Robot, mended: Any, contact: Contact) -> NDArray[np.float64]:
    from hitjoints.dynamics.inertia import mobility
    from hitjoints.dynamics.kinematics import point_jacobian

    rng = np.random.default_rng(0)
    data = mended.createData()
    ratios = []
    for q in rng.uniform(*robot.finite_limits, (SAMPLES, robot.n)):
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        jac = point_jacobian(robot.model, robot.data, q, contact)
        if not moves(jac, h @ jac):
            continue
        try:
            given = mobility(robot.model, robot.data, q, contact, h)
            ratios.append(mobility(mended, data, q, contact, h) / given)
        except ModelError:
            continue
    return np.array(ratios)
