"""Compare a kernel with its references: it serves only if they agree."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from hitjoints.errors import KernelMismatchError
from hitjoints.kernels.formulas.chain import Triple
from hitjoints.kernels.outputs import SAMPLES, Output, known_outputs
from hitjoints.kernels.reference import PinocchioAnswers

Array = np.ndarray[Any, np.dtype[np.float64]]


def samples(model: pin.Model, count: int = SAMPLES) -> tuple[Array, Array, Array]:
    """Return configurations within the limits, directions and masses to compare at.

    Returns:
        (count, n) rad or m, (count, 3) unit vectors, (count,) kg.
    """
    random = np.random.default_rng(0)
    low = np.maximum(model.lowerPositionLimit, -np.pi)
    high = np.minimum(model.upperPositionLimit, np.pi)
    q = random.uniform(low, np.maximum(low, high), (count, model.nv))
    h = random.normal(size=(count, 3))
    return q, h / np.linalg.norm(h, axis=1, keepdims=True), random.uniform(0.1, 5.0, count)


def check(
    model: pin.Model,
    contacts: Sequence[tuple[int, Triple]],
    inputs: tuple[Array, Array, Array],
    results: Mapping[str, Array],
) -> None:
    """Compare results with the references of their outputs.

    Args:
        model: the arm.
        contacts: joint and offset, (K).
        inputs: q, directions and masses, as from `samples`.
        results: the kernel's outputs for them.

    Raises:
        KernelMismatchError: an output has no reference, or deviates from it.
    """
    outputs, data = known_outputs(list(results)), model.createData()
    for k, contact in enumerate(contacts):
        for i, (q, h, mass) in enumerate(zip(*inputs, strict=True)):
            answers = PinocchioAnswers(model, data, q, contact, h, float(mass))
            for output in outputs:
                if i < output.samples and (output.anywhere or answers.moves):
                    _compare(output, contact, answers, results[output.name][k, i])


def _compare(
    output: Output, contact: tuple[int, Triple], answers: PinocchioAnswers, result: Array
) -> None:
    assert output.reference is not None
    expected = np.asarray(output.reference(answers))
    if np.isnan(expected).any():
        return
    size = _largest(expected)
    size = 1.0 + size if output.size is None else max(size, _largest(getattr(answers, output.size)))
    deviation, allowed = _largest(result - expected), output.tolerance * size
    if not deviation <= allowed:
        raise KernelMismatchError(
            f"{output.name} at joint {contact[0]}, offset {contact[1]}: "
            f"off by {deviation:.3g} from Pinocchio, {allowed:.3g} allowed"
        )


def _largest(values: Any) -> float:
    return float(np.abs(values).max())
