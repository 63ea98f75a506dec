"""Straight speed at and near singularities: rows, one configuration and HiGHS agree."""

import arms
import numpy as np
import pytest
from scipy.optimize import linprog

import hitjoints as hj

RANK = 1e-6
AXES = np.vstack((np.eye(3), -np.eye(3)))
EPSILONS = (0.0, *10.0 ** np.arange(-12.0, -2.0))


def highs(J, h, low, high):
    """The optimum with the rows across h that are longer than a millionth of the Jacobian."""
    if np.linalg.norm(h @ J) <= RANK * np.linalg.norm(J):
        return 0.0
    _, sizes, rows = np.linalg.svd(J - np.outer(h, h @ J), full_matrices=False)
    kept = rows[sizes > RANK * np.linalg.norm(J)]
    found = linprog(
        -(h @ J),
        A_eq=kept if len(kept) else None,
        b_eq=np.zeros(len(kept)) if len(kept) else None,
        bounds=np.column_stack((low, high)),
        method="highs",
        options={"primal_feasibility_tolerance": 1e-10, "dual_feasibility_tolerance": 1e-10},
    )
    return -found.fun


def undecided(J, h):
    """Whether round-off decides if a row counts."""
    sizes = np.linalg.svd(J - np.outer(h, h @ J), compute_uv=False)
    sizes = np.append(sizes, np.linalg.norm(h @ J)) / np.linalg.norm(J)
    return bool((np.abs(sizes / RANK - 1.0) < 1e-6).any())


@pytest.mark.parametrize("name", ["iiwa14", "iiwa7", "panda", "xarm7"])
def test_rows_and_one_configuration_agree_where_the_arm_is_singular(name):
    robot, rng = hj.load_robot(name), np.random.default_rng(1)
    corners = rng.choice([0.0, np.pi / 2, -np.pi / 2], (60, robot.n))
    low, high = robot.velocity_lower, robot.velocity_upper
    for joint in (3, 4, 5, 6, 7):
        epsilon = rng.choice(EPSILONS, (60, 1))
        q = corners + epsilon * rng.normal(size=corners.shape)
        h = AXES[rng.integers(6, size=60)]
        skew = rng.random(60) < 0.3
        h[skew] = arms.directions(int(skew.sum()), joint)
        rows = hj.hitting_speed(robot, q, joint, h, straight=True)
        for i in range(60):
            J = hj.jacobian(robot, q[i], joint)
            if undecided(J, h[i]):
                continue
            expected = highs(J, h[i], low, high)
            single = hj.hitting_speed(robot, q[i], joint, h[i], straight=True)
            label = f"{name} joint {joint}, {q[i].tolist()}, {h[i].tolist()}"
            assert rows[i] == pytest.approx(expected, rel=1e-8, abs=1e-9), label
            assert single == pytest.approx(expected, rel=1e-8, abs=1e-9), label


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("seed", range(6))
def test_a_row_across_that_is_round_off_is_none(backend, seed):
    """A random chain whose contact has a Jacobian of rank two to within any small number."""
    model, rng = arms.random_chain(seed, 4, prismatic=0.0), np.random.default_rng(seed)
    from hitjoints.kernels import build_kernel

    outputs = ("straight_speed", "jacobian", "speed")
    kernel = build_kernel(model, [(2, tuple(rng.uniform(0.1, 0.3, 3)))], outputs, backend)
    q, limit = arms.configurations(model, 40, seed), model.velocityLimit
    J = kernel(q, np.array([0.0, 0.0, 1.0]))["jacobian"][0]
    # along the directions of motion of joint 1 alone, the span of both, and slightly off that
    left = np.linalg.svd(J)[0]
    first = J[:, :, 0] / np.linalg.norm(J[:, :, 0], axis=1)[:, None]
    for tilt in (0.0, 1e-12, 1e-9, 1e-4, 1e-2):
        h = first + tilt * left[:, :, 2]
        h /= np.linalg.norm(h, axis=1)[:, None]
        result = kernel(q, h)["straight_speed"][0]
        for i in range(40):
            if not undecided(J[i], h[i]):
                expected = highs(J[i], h[i], -limit, limit)
                assert result[i] == pytest.approx(expected, rel=1e-8, abs=1e-9)


def test_one_of_the_two_ways_does_not_forget_that_a_contact_cannot_move():
    robot = hj.load_robot("xarm7")
    rng = np.random.default_rng(5)
    q = rng.uniform(robot.lower, robot.upper, (50, 7))
    for row in q:
        radius = hj.position(robot, row, 4) - hj.position(robot, row, 2)
        with pytest.raises(hj.InfeasibleError):
            hj.directional_inertia(robot, row, 4, radius)
        assert hj.directional_inertia(robot, [row], 4, radius)[0] == np.inf
        for straight in (False, True):
            assert hj.hitting_speed(robot, row, 4, radius, straight=straight) == 0.0
            assert hj.hitting_speed(robot, [row], 4, radius, straight=straight)[0] == 0.0
