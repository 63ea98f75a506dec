"""Hitting quantities of millions of configurations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin

from hitjoints.errors import InputError
from hitjoints.kernels.formulas.chain import Chain, Triple
from hitjoints.kernels.outputs import MASS, OUTPUTS, known_outputs, record
from hitjoints.kernels.tape.backends import Array, Runnable, evaluate, prepare
from hitjoints.kernels.verify import check, samples


class Kernel:
    """A compiled program for one arm, some contacts and some outputs; made by `build_kernel`.

    Args:
        runnable: the program on its back end.
        joints: number of joints n.
        contacts: joint and offset of each contact, K of them.
        outputs: names of the results.
    """

    def __init__(
        self,
        runnable: Runnable,
        joints: int,
        contacts: tuple[tuple[int, Triple], ...],
        outputs: tuple[str, ...],
    ) -> None:
        self.runnable, self.joints = runnable, joints
        self.contacts, self.outputs = contacts, outputs
        self._needs_mass = any(MASS in output.needs for output in known_outputs(outputs))

    def __call__(
        self,
        q: Array,
        direction: Array,
        mass: float | Array | None = None,
        threads: int | None = None,
        check: Callable[[int, int], None] | None = None,
    ) -> dict[str, Array]:
        """Evaluate all contacts at all configurations.

        Where a contact cannot move along the direction (|J^T h| up to `rank_floor`) the limits are
        returned: inertia inf, gradient nan, speeds and fluxes 0.

        Args:
            q: (N, n) configurations (rad, m).
            direction: (3,) unit vector in the world, or (N, 3) one per row.
            mass: object's mass (kg), a number or (N,); needed by flux and straight_flux only.
            threads: None for as many as help; the results do not depend on it.
            check: looks at rows start..stop of q before they are evaluated, and may raise.

        Returns:
            Each output with contacts and rows first: inertia (K, N) kg, gradient (K, N, n) kg/rad,
            speed and straight_speed (K, N) m/s, flux and straight_flux (K, N) m/s, position (K, N,
            3) m, jacobian (K, N, 3, n) m/rad, mobility (K, N) 1/kg, mobility_gradient (K, N, n)
            1/(kg rad), response (K, N, n) rad/s per N s. Arrays with components are views with the
            rows contiguous.

        Raises:
            InputError: a shape does not fit, or the mass is missing.
        """
        q = np.asarray(q, dtype=np.float64)
        if q.ndim != 2 or q.shape[1] != self.joints:
            raise InputError("q", f"shape {q.shape}", f"(N, {self.joints}) is expected")
        rows = len(q)
        h = np.asarray(direction, dtype=np.float64)
        if h.shape not in {(3,), (rows, 3)}:
            raise InputError("direction", f"shape {h.shape}", f"(3,) or ({rows}, 3) is expected")
        if mass is None and self._needs_mass:
            raise InputError("mass", None, "the flux needs the object's mass (kg)")
        m = np.atleast_1d(np.asarray(0.0 if mass is None else mass, dtype=np.float64))
        if m.shape not in {(1,), (rows,)}:
            raise InputError("mass", f"shape {m.shape}", f"a number or ({rows},) is expected")
        inputs = [*q.T, *(h.T if h.ndim == 2 else h[:, None]), m]
        count = len(self.runnable.program.outputs)
        values = evaluate(self.runnable, count, inputs, rows, threads, check=check)
        return self.named(values, self.outputs)

    def named(self, values: Array, outputs: Sequence[str]) -> dict[str, Array]:
        """Cut a program's values (components, N) into arrays with contacts and rows first."""
        sizes = {"": (), "n": (self.joints,), "3": (3,), "3n": (3, self.joints)}
        results: dict[str, Array] = {}
        start = 0
        for name in outputs:
            shape = (len(self.contacts), *sizes[OUTPUTS[name].shape])
            stop = start + int(np.prod(shape))
            results[name] = np.moveaxis(values[start:stop].reshape(*shape, -1), -1, 1)
            start = stop
        return results


def build_kernel(
    model: pin.Model,
    contacts: Sequence[tuple[int, Sequence[float]]],
    outputs: Sequence[str] = ("inertia",),
    backend: str | None = None,
) -> Kernel:
    """Compile the outputs for an arm and check them against Pinocchio.

    Args:
        model: serial fixed-base arm, see `Chain.from_model`; limits are built in as they are now.
        contacts: 1-based joint and contact point in the joint's frame (m), at least one.
        outputs: see `Kernel.__call__`, at least one.
        backend: "llvm" or "numpy"; None for HITJOINTS_BACKEND, else the fastest that works.

    Raises:
        InputError: an unknown output or back end, a contact that does not exist.
        ModelError: the model is not a serial arm.
        KernelMismatchError: the kernel disagrees with Pinocchio.
    """
    if not contacts or not outputs:
        raise InputError("contacts" if not contacts else "outputs", "()", "at least one is needed")
    known_outputs(outputs)
    chain = Chain.from_model(model)
    known = tuple((joint, _offset(offset)) for joint, offset in contacts)
    program = record(chain, [chain.attach(*contact) for contact in known], tuple(outputs))
    runnable = prepare(program, chain.size, backend)
    kernel = Kernel(runnable, chain.size, known, tuple(outputs))
    inputs = samples(model)
    check(model, known, inputs, kernel(*inputs, threads=1))
    return kernel


def _offset(offset: Sequence[float]) -> Triple:
    if len(offset) != 3:
        raise InputError("offset", offset, "three finite numbers (m) are expected")
    return float(offset[0]), float(offset[1]), float(offset[2])
