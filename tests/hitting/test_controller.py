from __future__ import annotations

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.dynamics.contact_point import ContactPoint
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.hit import Hit
from hitjoints.hitting.controller import Controller
from hitjoints.hitting.manipulability_posture import most_manipulable
from hitjoints.hitting.step import Gains
from hitjoints.programs.joint_velocity import solve_joint_velocity

OBJECT, ALONG = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])
Q = np.array([-0.34, 1.41, -1.38, 1.6, 0.48, 1.97, 1.32])


@pytest.fixture
def robot(arm):
    return arm("iiwa14")


@pytest.fixture
def hit():
    return Hit(6, OBJECT, ALONG, 2.0, 0.3)


def test_a_step_is_equation_7_and_equation_13(robot, hit):
    gains = Gains(posture=0.4, inertia=0.01)
    control = Controller(robot, hit, Q, dt=0.002, gains=gains)
    qd = control.step(Q)
    inertia = hj.directional_inertia(robot, Q, 6, ALONG)
    gradient = hj.directional_inertia_gradient(robot, Q, 6, ALONG)
    J, here = hj.jacobian(robot, Q, 6), hj.position(robot, Q, 6)
    speed = hj.required_speed(inertia, 2.0, 0.3)
    error = here - OBJECT - ALONG * (ALONG @ (here - OBJECT))
    alpha = np.exp(-np.linalg.norm(error) / 0.01)
    f = alpha * speed * ALONG - (1 - alpha) * 20.0 * error
    f *= speed / np.linalg.norm(f)
    limits = robot.velocity_lower, robot.velocity_upper
    ahead = solve_joint_velocity(J, f, ALONG, inertia, 2.0, 0.3, *limits).qd
    desired = hj.directional_inertia(robot, Q + 0.002 * ahead, 6, ALONG)
    assert control.last.desired_inertia == pytest.approx(desired, abs=1e-6)
    pinv = np.linalg.pinv(J)
    wish = 0.4 * (control.posture - Q) - 0.01 * gradient * (inertia - desired)
    expected = pinv @ f + (np.eye(7) - pinv @ J) @ wish
    np.testing.assert_allclose(qd, expected, atol=1e-7)


def test_what_a_step_tells(robot, hit):
    control = Controller(robot, hit, Q)
    assert control.last is None
    assert not control.arrived
    qd = control.step(Q)
    seen = control.last
    assert seen.inertia == pytest.approx(hj.directional_inertia(robot, Q, 6, ALONG))
    assert seen.speed == pytest.approx(ALONG @ hj.jacobian(robot, Q, 6) @ qd)
    assert seen.flux == pytest.approx(hj.hitting_flux(seen.inertia, 2.0, seen.speed))
    assert not seen.saturated
    assert not seen.braked


def test_an_impossible_flux_is_reported_and_the_limits_hold(robot):
    control = Controller(robot, Hit(6, OBJECT, ALONG, 2.0, 5.0), Q)
    qd = control.step(Q)
    assert control.last.saturated
    assert ((qd >= robot.velocity_lower) & (qd <= robot.velocity_upper)).all()
    velocity = hj.jacobian(robot, Q, 6) @ qd
    assert velocity @ ALONG > 0.3  # it still goes as fast as it can, towards the line


def test_observe_agrees_with_the_quantities(robot):
    contact = hj.Contact(6, (0.05, -0.02, 0.1))
    seen = ContactPoint(robot, contact).observe(Q, ALONG)
    np.testing.assert_allclose(seen.position, hj.position(robot, Q, contact), atol=1e-15)
    np.testing.assert_allclose(seen.J, hj.jacobian(robot, Q, contact), atol=1e-15)


def test_it_brakes_when_nothing_is_certified(robot, hit):
    control = Controller(robot, hit, Q, compiled=False)
    first = control.step(Q).copy()
    control._law = lambda *_: None
    slower = control.step(Q)
    assert control.last.braked
    np.testing.assert_allclose(slower, first / 2)


def test_the_inertia_term_reduces_the_error(robot, hit):
    def inertia_after(gain):
        control = Controller(
            robot, hit, Q, reference="constant", inertia=5.0, gains=Gains(0.0, gain)
        )
        q = Q
        for _ in range(30):
            q = q + control.dt * control.step(q)
        return hj.directional_inertia(robot, q, 6, ALONG)

    assert abs(inertia_after(0.5) - 5.0) < abs(inertia_after(0.0) - 5.0)


@pytest.mark.parametrize(
    ("options", "name"),
    [
        ({"dt": 0.0}, "dt"),
        ({"dt": 1.0}, "dt"),
        ({"reference": "best"}, "reference"),
        ({"law": "pid"}, "law"),
        ({"weighting": "mass"}, "weighting"),
        ({"speed_profile": "fast"}, "speed_profile"),
        ({"posture": 9 * Q}, "posture"),
    ],
)
def test_bad_arguments_are_named(robot, hit, options, name):
    with pytest.raises(InputError) as caught:
        Controller(robot, hit, Q, **options)
    assert caught.value.argument == name


@pytest.mark.parametrize("q", [Q + 9, Q * np.nan, Q[:3]])
def test_a_step_refuses_what_is_no_configuration(robot, hit, q):
    with pytest.raises(InputError):
        Controller(robot, hit, Q).step(q)


@pytest.mark.parametrize(
    ("values", "name"),
    [
        ((6, [0.5, 0.3], ALONG, 2.0, 0.3), "position"),
        ((6, OBJECT, np.zeros(3), 2.0, 0.3), "direction"),
        ((6, OBJECT, ALONG, 0.0, 0.3), "mass"),
        ((6, OBJECT, ALONG, 2.0, 0.0), "flux"),
        ((6, OBJECT, ALONG, 2.0, np.inf), "flux"),
    ],
)
def test_bad_hits_are_refused(values, name):
    with pytest.raises(InputError) as caught:
        Hit(*values)
    assert caught.value.argument == name


def test_the_posture_is_the_most_manipulable(robot):
    best = most_manipulable(robot, 6, OBJECT, Q)
    np.testing.assert_allclose(hj.position(robot, best, 6), OBJECT, atol=1e-8)
    others = hj.place_joint(robot, 6, np.tile(OBJECT, (300, 1)), seed=7)
    most = max(hj.manipulability(robot, q, 6) for q in others.q[others.solved])
    assert hj.manipulability(robot, best, 6) >= 0.985 * most
    np.testing.assert_array_equal(best[5:], Q[5:])  # they do not move the joint


def test_a_position_out_of_reach_has_no_posture(robot):
    with pytest.raises(InfeasibleError, match="out of reach"):
        most_manipulable(robot, 6, [2.0, 0.0, 0.5], Q)
