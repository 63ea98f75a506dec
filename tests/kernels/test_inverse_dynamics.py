"""Torques of many states against Pinocchio and against the work they do."""

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.errors import KernelMismatchError
from hitjoints.kernels.formulas import torques
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.inverse_dynamics import build_inverse_dynamics
from tests.kernels.arms import configurations, iiwa14, panda, random_chain

MODELS = [iiwa14, panda, *(lambda s=s: random_chain(s) for s in range(6))]


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("model", MODELS)
def test_torques_are_pinocchios(model, backend):
    model = pin.Model(model())
    model.gravity.linear = np.array([1.0, -2.0, -9.0])
    run = build_inverse_dynamics(model, Chain.from_model(model), backend)
    q = configurations(model, 50)
    qd, qdd = np.random.default_rng(3).normal(size=(2, *q.shape)) * 4
    data = model.createData()
    expected = np.array([pin.rnea(model, data, *row) for row in zip(q, qd, qdd, strict=True)])
    found = run(q.T, qd.T, qdd.T).T
    np.testing.assert_allclose(found, expected, atol=1e-11 * np.abs(expected).max())


def test_torques_do_the_work_that_the_energy_gains():
    model = random_chain(9)
    run, data = build_inverse_dynamics(model, Chain.from_model(model)), model.createData()
    q = configurations(model, 20, seed=4)
    qd, qdd = np.random.default_rng(5).normal(size=(2, *q.shape))
    power = (run(q.T, qd.T, qdd.T).T * qd).sum(axis=1)

    def energy(q, qd):
        M = np.triu(pin.crba(model, data, q))
        kinetic = qd @ (M + np.triu(M, 1).T) @ qd / 2
        return kinetic + pin.computePotentialEnergy(model, data, q)

    t = 1e-5
    for row in range(len(q)):
        after, before = (
            energy(q[row] + s * qd[row] + s**2 / 2 * qdd[row], qd[row] + s * qdd[row])
            for s in (t, -t)
        )
        assert power[row] == pytest.approx((after - before) / (2 * t), abs=1e-5)


def test_formulas_that_are_wrong_do_not_serve(monkeypatch):
    model = iiwa14()
    monkeypatch.setattr(torques, "_of_point", lambda omega, alpha, r: (0.0, 0.0, 0.0))
    with pytest.raises(KernelMismatchError, match="torques"):
        build_inverse_dynamics(model, Chain.from_model(model), "numpy")
