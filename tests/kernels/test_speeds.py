"""Speeds against linear programs."""

import arms
import numpy as np
import pytest
from scipy.optimize import linprog

from hitjoints.kernels import build_kernel
from hitjoints.kernels.reference import straight_optimum


def fastest(J, h, low, high, straight):
    across = np.linalg.svd(h[None])[2][1:]
    rows = {"A_eq": across @ J, "b_eq": np.zeros(2)} if straight else {}
    options = {"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10}
    bounds = np.column_stack((low, high))
    return -linprog(-J.T @ h, bounds=bounds, method="highs", options=options, **rows).fun


def straight_elbow(model, q):
    q = q.copy()
    q[: len(q) // 4, 3] = 0.0
    return q


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("joint", [3, 4, 5, 6, 7])
@pytest.mark.parametrize("make", [arms.iiwa14, arms.panda])
def test_speeds_match_highs(make, joint, backend):
    model, count = make(), 120
    offset = (0.02, 0.0, 0.05) if joint % 2 else (0.0, 0.0, 0.0)
    outputs = ("speed", "straight_speed", "jacobian")
    q = straight_elbow(model, arms.configurations(model, count, joint))
    h = arms.directions(count, joint)
    result = build_kernel(model, [(joint, offset)], outputs, backend)(q, h)
    limit = model.velocityLimit
    for i in range(count):
        J = result["jacobian"][0, i]
        for name, straight in (("speed", False), ("straight_speed", True)):
            expected = fastest(J, h[i], -limit, limit, straight)
            assert result[name][0, i] == pytest.approx(expected, rel=1e-9, abs=2e-9), name


def test_straight_speed_is_reached_in_thousands_of_configurations():
    model, count = arms.iiwa14(), 3000
    q, h = arms.configurations(model, count), arms.directions(count)
    kernel = build_kernel(model, [(6, (0.03, 0.01, 0.0))], ("straight_speed", "speed", "jacobian"))
    result, limit = kernel(q, h), model.velocityLimit
    reached = [
        straight_optimum(J, n, -limit, limit) for J, n in zip(result["jacobian"][0], h, strict=True)
    ]
    certified = np.isfinite(reached)
    assert certified.mean() > 0.99
    exact = np.array(reached)[certified]
    assert result["straight_speed"][0][certified] == pytest.approx(exact, rel=1e-9, abs=1e-12)
    assert np.all(result["straight_speed"] <= result["speed"] * (1.0 + 1e-12))


def test_lateral_motion_of_rank_one_is_exact():
    """A point near a straight arm's tip: all joints move it in one lateral direction only."""
    model = arms.iiwa14()
    kernel = build_kernel(model, [(7, (0.0, 0.0, 0.1))], ("straight_speed", "jacobian"))
    h = np.array([0.0, 1.0, 0.0])
    q = np.zeros((16, 7))
    q[:, 1] = np.linspace(0.1, 1.0, 16)
    result, limit = kernel(q, h), model.velocityLimit
    for value, J in zip(result["straight_speed"][0], result["jacobian"][0], strict=True):
        assert value == pytest.approx(fastest(J, h, -limit, limit, True), abs=1e-9)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_asymmetric_limits_are_honoured(backend):
    model = arms.random_chain(5, 6, prismatic=0.2)
    if not hasattr(model, "lowerVelocityLimit"):
        pytest.skip("this Pinocchio has symmetric velocity limits only")
    model.lowerVelocityLimit = -0.3 * model.velocityLimit
    low, high = model.lowerVelocityLimit, model.velocityLimit
    outputs = ("speed", "straight_speed", "jacobian")
    q, h = arms.configurations(model, 60), arms.directions(60)
    result = build_kernel(model, [(6, (0.1, 0.0, 0.0))], outputs, backend)(q, h)
    for i in range(60):
        J = result["jacobian"][0, i]
        for name, straight in (("speed", False), ("straight_speed", True)):
            expected = fastest(J, h[i], low, high, straight)
            assert result[name][0, i] == pytest.approx(expected, rel=1e-9, abs=2e-9)


def test_flux_is_speed_shared_with_the_object():
    outputs = ("inertia", "speed", "flux", "straight_speed", "straight_flux")
    kernel = build_kernel(arms.panda(), [(5, (0, 0, 0)), (7, (0, 0, 0.1))], outputs)
    q, h = arms.configurations(arms.panda(), 100), arms.directions(100)
    mass = np.linspace(0.0, 5.0, 100)
    r = kernel(q, h, mass)
    share = r["inertia"] / (r["inertia"] + mass)
    assert r["flux"] == pytest.approx(share * r["speed"], rel=1e-12)
    assert r["straight_flux"] == pytest.approx(share * r["straight_speed"], rel=1e-12)
