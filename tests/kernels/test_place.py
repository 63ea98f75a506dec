"""Batched inverse kinematics."""

import time

import arms
import numpy as np
import pinocchio as pin
import pytest

from hitjoints.errors import InputError, KernelMismatchError
from hitjoints.kernels import build_kernel, ik, place

CONTACTS = [(5, (0, 0, 0)), (6, (0.03, 0.05, 0.02)), (7, (0.0, 0.0, 0.0)), (7, (0.08, 0.0, 0.1))]


def targets(model, contact, count, seed=0):
    kernel = build_kernel(model, [contact], ("position",))
    return kernel(arms.configurations(model, count, seed), np.array([1.0, 0, 0]))["position"][0]


@pytest.mark.parametrize("contact", CONTACTS)
@pytest.mark.parametrize("make", [arms.iiwa14, arms.panda])
def test_reachable_targets_are_reached_within_limits(make, contact):
    model = make()
    positions = targets(model, contact, 50_000)
    found = place(model, contact, positions)
    assert found.solved.all()
    assert found.q.shape == (50_000, 7)
    assert np.all(found.q >= model.lowerPositionLimit)
    assert np.all(found.q <= model.upperPositionLimit)
    data = model.createData()
    for q, position in zip(found.q[:200], positions[:200], strict=True):
        pin.forwardKinematics(model, data, q)
        assert np.linalg.norm(data.oMi[contact[0]].act(np.array(contact[1])) - position) < 1e-9


def test_numpy_backend_places_too():
    positions = targets(arms.panda(), (6, (0, 0, 0)), 1000)
    assert place(arms.panda(), (6, (0, 0, 0)), positions, backend="numpy").solved.all()


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_result_depends_on_the_row_only(backend):
    model, contact = arms.panda(), (7, (0, 0, 0.1))
    positions = targets(model, contact, 3000)
    positions[::50] *= 3.0
    whole = place(model, contact, positions, seed=5, threads=1, backend=backend)
    again = place(model, contact, positions, seed=5, threads=3, backend=backend)
    assert np.array_equal(whole.q, again.q)
    for rows in (np.arange(7), np.arange(7, 1003), np.arange(2999, 1000, -3)):
        part = place(model, contact, positions[rows], seed=5, rows=rows, backend=backend)
        assert np.array_equal(part.q, whole.q[rows])
        assert np.array_equal(part.error, whole.error[rows])
    other = place(model, contact, positions, seed=6, backend=backend)
    assert not np.array_equal(other.q, whole.q)


def test_repeated_position_gives_different_configurations():
    model, contact = arms.iiwa14(), (6, (0, 0, 0))
    found = place(model, contact, np.repeat([[0.5, 0.2, 0.5]], 500, axis=0))
    assert found.solved.all()
    assert np.all(np.ptp(found.q, axis=0) > 1.0)


def test_start_is_used_and_idle_joints_keep_it():
    model, contact = arms.iiwa14(), (5, (0, 0, 0))
    start = np.array([0.1, 0.5, -0.2, 1.0, 0.3, -0.4, 0.7])
    kernel = build_kernel(model, [contact], ("position",))
    reached = kernel(start[None], np.array([1.0, 0, 0]))["position"][0]
    near = reached + np.random.default_rng(0).normal(size=(20, 3)) * 0.01
    found = place(model, contact, np.vstack((reached, near)), start=start)
    assert found.solved.all()
    assert np.array_equal(found.q[0], start)
    assert np.all(np.abs(found.q - start).max(axis=1) < 0.3)
    assert np.array_equal(found.q[:, 4:], np.tile(start[4:], (21, 1)))
    far = place(model, contact, targets(model, contact, 2000), start=np.tile(start, (2000, 1)))
    assert far.solved.all()
    assert np.array_equal(far.q[:, 4:], np.tile(start[4:], (2000, 1)))


def test_random_chains_with_slides_and_endless_joints():
    for seed in range(12):
        model = arms.random_chain(seed, 6, prismatic=0.2)
        limit = np.full(6, np.inf)
        limit[1] = 1.5
        model.lowerPositionLimit, model.upperPositionLimit = -limit, limit
        contact = (6, (0.1, 0.0, 0.05))
        found = place(model, contact, targets(model, contact, 500))
        assert found.solved.mean() > 0.99
        assert np.all(np.abs(found.q[:, 1]) <= 1.5)


def test_unreachable_targets_cost_little_and_end_close():
    model, contact = arms.iiwa14(), (7, (0, 0, 0))
    direction = arms.directions(100_000)
    positions = np.array([0.0, 0.0, 0.36]) + 2.0 * direction
    began = time.perf_counter()
    found = place(model, contact, positions)
    assert time.perf_counter() - began < 10.0
    assert not found.solved.any()
    upright = np.abs(direction[:, 2]) < 0.5
    assert found.error.min() >= 2.0 - 0.901 - 1e-9
    assert np.median(found.error[upright]) < 2.0 - 0.901 + 0.05
    assert np.all(found.q <= model.upperPositionLimit)


def test_disagreement_with_pinocchio_is_refused(monkeypatch):
    model, contact = arms.iiwa14(), (6, (0, 0, 0))
    monkeypatch.setattr(ik.Search, "errors", lambda self, q, t, threads: np.full(q.shape[1], 1e-3))
    with pytest.raises(KernelMismatchError):
        place(model, contact, targets(model, contact, 10))


def test_wrong_input_is_refused():
    model, contact = arms.iiwa14(), (6, (0, 0, 0))
    for positions in (np.zeros(3), np.zeros((2, 2)), np.full((2, 3), np.nan)):
        with pytest.raises(InputError, match="positions"):
            place(model, contact, positions)
    with pytest.raises(InputError, match="start"):
        place(model, contact, np.zeros((2, 3)), start=np.zeros(6))
    with pytest.raises(InputError, match="rows"):
        place(model, contact, np.zeros((2, 3)), rows=np.arange(3))
    with pytest.raises(InputError, match="joint"):
        place(model, (8, (0, 0, 0)), np.zeros((2, 3)))
    assert place(model, contact, np.zeros((0, 3))).q.shape == (0, 7)
