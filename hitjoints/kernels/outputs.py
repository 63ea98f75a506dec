"""What a kernel can compute: one line per output, with what it is checked against."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import attrgetter as answer
from typing import Any

from hitjoints.errors import InputError, KernelMismatchError, UnknownNameError
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.formulas.hit_formulas import Attachment, HitFormulas
from hitjoints.kernels.formulas.links import TracedArm
from hitjoints.kernels.formulas.mass_matrix import Factor, mass_matrix, unit_matrix
from hitjoints.kernels.reference import PinocchioAnswers
from hitjoints.kernels.tape.trace import Scalar, Tape, Tracer

SAMPLES = 24
"""Configurations at which an output is compared when a kernel is built."""
FEW = 8
"""The same where the reference is a small enumeration."""
MASS, LIMITS = "the object's mass (kg)", "a velocity limit for every joint"
INERTIA = "an inertia that every joint carries"
"""What an output may need."""


@dataclass(frozen=True)
class Output:
    """One output of a kernel.

    Attributes:
        name: as it is asked for.
        shape: the axes beside contact and row: "", "3", "n" or "3n".
        formula: its components over abstract numbers.
        reference: the answer it is compared with when a kernel is built; without one none is.
        tolerance: largest deviation from it, as a share of its size.
        needs: of `MASS`, `LIMITS` and `INERTIA`.
        size: the answer whose size counts if it exceeds the output's own; None for 1 plus the own.
        anywhere: compared also where the contact hardly moves along the direction.
        samples: at how many configurations it is compared.
    """

    name: str
    shape: str
    formula: Callable[[HitFormulas], list[Scalar]]
    reference: Callable[[PinocchioAnswers], Any] | None
    tolerance: float
    needs: tuple[str, ...] = ()
    size: str | None = None
    anywhere: bool = False
    samples: int = SAMPLES


F = HitFormulas
OUTPUTS = {
    output.name: output
    for output in (
        Output("inertia", "", F.inertia, answer("inertia"), 1e-10, (INERTIA,), "inertia"),
        Output("gradient", "n", F.gradient, answer("gradient"), 1e-9, (INERTIA,), "inertia"),
        Output("mobility", "", F.mobility, answer("mobility"), 1e-10, (INERTIA,), "mobility"),
        Output(
            "mobility_gradient",
            "n",
            F.mobility_gradient,
            answer("mobility_gradient"),
            1e-9,
            (INERTIA,),
            size="mobility",
        ),
        Output("response", "n", F.response, answer("response"), 1e-9, (INERTIA,), "response"),
        Output("position", "3", F.position, answer("position"), 1e-12, anywhere=True),
        Output("jacobian", "3n", F.jacobian, answer("jacobian"), 1e-12, anywhere=True),
        Output("speed", "", F.speed, answer("speed"), 1e-10, (LIMITS,)),
        Output("flux", "", F.flux, answer("flux"), 1e-10, (LIMITS, MASS, INERTIA)),
        Output(
            "straight_speed",
            "",
            F.straight_speed,
            answer("straight_speed"),
            1e-8,
            (LIMITS,),
            samples=FEW,
        ),
        Output(
            "straight_flux",
            "",
            F.straight_flux,
            answer("straight_flux"),
            1e-8,
            (LIMITS, MASS, INERTIA),
            samples=FEW,
        ),
    )
}
"""Every output by its name. Another one takes a line here."""


def known_outputs(names: Sequence[str]) -> list[Output]:
    """Return the outputs of some names.

    Raises:
        UnknownNameError: there is no such output.
        KernelMismatchError: an output has no reference to be checked against.
    """
    for name in names:
        if name not in OUTPUTS:
            raise UnknownNameError("outputs", name, OUTPUTS)
        if OUTPUTS[name].reference is None:
            raise KernelMismatchError(f"{name} has no reference to be checked against")
    return [OUTPUTS[name] for name in names]


def factor_for(wanted: Sequence[Output], arm: TracedArm) -> Factor:
    """Return the factors of the arm's mass matrix, if an output needs them.

    Where none does, those of any other matrix serve, and an arm without mass has an answer.

    Raises:
        ModelError: a joint carries no inertia.
    """
    dynamic = any(INERTIA in output.needs for output in wanted)
    return Factor(mass_matrix(arm) if dynamic else unit_matrix(len(arm.links)))


def record(chain: Chain, contacts: Sequence[Attachment], outputs: Sequence[str]) -> Tape:
    """Record the outputs of all contacts as one program.

    Its inputs are q (n), the direction (3) and the object's mass; its outputs are grouped by
    output, then by contact, then by component.

    Args:
        chain: the arm.
        contacts: as `Chain.attach` returns them.
        outputs: names from `OUTPUTS`.

    Raises:
        InputError: an output needs a joint speed limit that the model does not have.
        ModelError: it needs an inertia that a joint does not carry.
        UnknownNameError, KernelMismatchError: as `known_outputs`.
    """
    wanted = known_outputs(outputs)
    if any(LIMITS in output.needs for output in wanted) and not chain.has_speed_limits:
        raise InputError("outputs", tuple(outputs), "speeds need a velocity limit for every joint")
    n = chain.size
    tracer = Tracer(n + 4)
    h = tracer.inputs[n], tracer.inputs[n + 1], tracer.inputs[n + 2]
    arm = TracedArm(chain, tracer.inputs[:n])
    factor = factor_for(wanted, arm)
    hits = [HitFormulas(arm, factor, contact, h, tracer.inputs[n + 3]) for contact in contacts]
    return tracer.program(
        [value for output in wanted for hit in hits for value in output.formula(hit)]
    )
