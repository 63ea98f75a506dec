"""Joint torques of many states at once."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from hitjoints.errors import KernelMismatchError
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.formulas.torques import record_torques
from hitjoints.kernels.tape.backends import Array, Runnable, evaluate, prepare
from hitjoints.kernels.verify import samples

AGREES = 1e-10
"""Largest deviation from Pinocchio, relative to 1 plus the largest torque."""


class InverseDynamics:
    """A compiled program of one arm; made by `build_inverse_dynamics`.

    Args:
        runnable: the program on its back end.
    """

    def __init__(self, runnable: Runnable) -> None:
        self.runnable = runnable

    def __call__(self, q: Array, qd: Array, qdd: Array, threads: int | None = None) -> Array:
        """Return the torques (n, N) N m, gravity and rotors included, of states as columns.

        Args:
            q: (n, N) rad.
            qd: (n, N) rad/s.
            qdd: (n, N) rad/s^2.
            threads: None for as many as help.
        """
        states = np.concatenate((q, qd, qdd))
        return evaluate(self.runnable, len(q), states, q.shape[1], threads)


def build_inverse_dynamics(
    model: pin.Model, chain: Chain, backend: str | None = None
) -> InverseDynamics:
    """Make the torques of an arm ready, and check them against Pinocchio.

    Args:
        model: serial fixed-base arm.
        chain: of it.
        backend: see `build_kernel`.

    Raises:
        KernelMismatchError: they disagree.
    """
    x, y, z = (float(v) for v in model.gravity.linear)
    run = InverseDynamics(prepare(record_torques(chain, (x, y, z)), 3 * chain.size, backend))
    q = samples(model)[0]
    qd, qdd = np.random.default_rng(1).normal(size=(2, *q.shape))
    data = model.createData()
    expected = np.array([pin.rnea(model, data, *row) for row in zip(q, qd, qdd, strict=True)])
    deviation = float(np.abs(run(q.T, qd.T, qdd.T, threads=1).T - expected).max())
    if not deviation <= AGREES * (1.0 + float(np.abs(expected).max())):
        raise KernelMismatchError(f"torques: off by {deviation:.3g} N m from Pinocchio")
    return run
