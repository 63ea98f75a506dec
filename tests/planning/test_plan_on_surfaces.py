"""Contacts that move on a surface, and objects at the very edge of reach."""

import numpy as np
import pytest
from scipy.optimize import linprog

import hitjoints as hj
from hitjoints.planning.objectives.freedom import is_blind
from hitjoints.planning.planner import plan

POSITION = np.array([-0.27797230986022964, 0.0768261930101187, 0.193280981101795])
ALONG = (0.30149146512732844, 0.940506429518749, -0.15668615921411685)


def one(robot, position, direction, mass=2.0, **options):
    return plan(robot, position, direction, mass, certificate=False, **options).candidates[0]


def tangents(robot, joint, position):
    """The plane that a joint moves in at a position, and its normal."""
    q = hj.place_joint(robot, joint, np.tile(position, (20, 1))).q
    jacobians = [hj.jacobian(robot, row, joint) for row in q]
    clearest = max(jacobians, key=lambda J: np.linalg.svd(J, compute_uv=False)[1])
    left = np.linalg.svd(clearest)[0]
    return left[:, :2], left[:, 2]


def test_which_contacts_are_blind(arm):
    robot = arm("xarm7")
    assert [is_blind(robot, robot.contact(k)) for k in (3, 4, 5, 7)] == [True, True, False, False]


def test_nearly_a_surface_gives_the_straight_maximum(arm):
    """The elbow of xarm7: rounded angles leave 1e-7 of a third direction."""
    robot = arm("xarm7")
    options = {"joints": [4], "objective": "straight-flux", "away": False}
    found = [one(robot, POSITION, ALONG, seed=seed, **options) for seed in range(3)]
    values = [candidate.straight_flux for candidate in found]
    np.testing.assert_allclose(values, values[0], rtol=1e-4)
    best = found[0]
    assert np.linalg.norm(hj.position(robot, best.q, 4) - POSITION) < 1e-6
    # The speed by HiGHS, the motion in the plane only.
    h = np.array(ALONG) / np.linalg.norm(ALONG)
    plane, _ = tangents(robot, 4, POSITION)
    across = plane @ np.linalg.svd((plane.T @ h)[None])[2][1]
    J = hj.jacobian(robot, best.q, 4)
    bounds = np.column_stack((robot.velocity_lower, robot.velocity_upper))
    peer = linprog(-(h @ J), A_eq=(across @ J)[None], b_eq=[0], bounds=bounds)
    assert best.straight_speed == pytest.approx(-peer.fun, rel=1e-6)
    # No sample of the self-motion does better.
    q = hj.place_joint(robot, 4, np.tile(POSITION, (300, 1)), seed=9).q
    flux = hj.hitting_flux(
        hj.directional_inertia(robot, q, 4, h), 2.0, hj.hitting_speed(robot, q, 4, h, straight=True)
    )
    assert flux.max() <= best.straight_flux * (1 + 1e-9)


def test_every_tangential_direction_can_be_hit(arm):
    robot = arm("xarm7")
    rng = np.random.default_rng(4)
    for i in range(8):
        position = hj.position(robot, rng.uniform(*robot.finite_limits), 4)
        plane, normal = tangents(robot, 4, position)
        h = plane @ rng.standard_normal(2)
        options = {"joints": [4], "objective": "straight-flux", "away": False, "seed": i}
        assert one(robot, position, h, **options).straight_flux > 1e-3
        refused = one(robot, position, h + normal, **options)
        assert not refused.feasible
        assert "rank 2, it moves in a plane" in refused.reason


def test_inertia_on_a_surface_does_not_depend_on_the_seed(arm):
    robot = arm("xarm7")
    position = (-0.05164013364404178, 0.0022580643580881717, 0.5601438872762925)
    direction = (0.7263227508367031, 0.6705026241907031, 0.1512662968753626)
    found = [one(robot, position, direction, 0.229, joints=[4], seed=seed) for seed in range(3)]
    inertia = [candidate.inertia for candidate in found]
    np.testing.assert_allclose(inertia, inertia[0], rtol=2e-3)


@pytest.mark.parametrize("name", ["panda", "iiwa14", "xarm7"])
def test_at_the_edge_of_reach(arm, name):
    """Nothing crashes a hair's breadth before, at and beyond the edge; a plan keeps its promise."""
    robot = arm(name)
    rng = np.random.default_rng(0)
    answered = 0
    for joint in range(4, robot.n + 1):
        q = rng.uniform(*robot.finite_limits, (200, robot.n))
        at = np.array([hj.position(robot, row, joint) for row in q])
        far = at[np.argmax(np.linalg.norm(at - hj.position(robot, q[0], 2), axis=1))]
        for shift in (0.0, 1e-10, 6e-10, 1e-8):
            found = one(robot, far * (1 + shift), rng.standard_normal(3), joints=[joint])
            if found.feasible:
                answered += 1
                assert np.linalg.norm(hj.position(robot, found.q, joint) - far) < 1e-6
            else:
                assert found.reason
    assert answered > 3


def test_an_elbow_a_hair_beyond_its_sphere(arm):
    found = one(
        arm("panda"), (-0.03548019074096448, 0, 0.657658906601124), (-0.1, 0, 1), joints=[4]
    )
    assert found.feasible
    assert found.position_error < 1e-8


@pytest.mark.parametrize("objective", ["inertia", "flux", "straight-flux", "rebound"])
def test_the_maximum_as_printed_can_be_asked_for(arm, objective):
    robot, hit = arm("iiwa14"), ([0.5, 0.3, 0.5], [0, 1, 0])
    for joint, seed in ((6, 0), (7, 1)):
        most = one(robot, *hit, joints=[joint], objective="flux").flux
        for flux in (most, most * (1 + 1e-9), most * (1 - 1e-9)):
            found = one(robot, *hit, joints=[joint], objective=objective, flux=flux, seed=seed)
            assert found.feasible, found.reason
            assert found.flux == pytest.approx(flux, rel=1e-6)
        refused = one(robot, *hit, joints=[joint], objective=objective, flux=most * (1 + 1e-5))
        assert not refused.feasible
        reached, asked = [float(w) for w in refused.reason.split() if w[:2] in ("0.", "1.")]
        assert reached < asked
