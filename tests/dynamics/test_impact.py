"""Eq. 1-4 and 11: momentum, restitution, limits, broadcasting, refusals."""

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import jacobian
from hitjoints.errors import InputError
from hitjoints.impact.collision import hitting_flux, object_speed, rebound, required_speed
from hitjoints.model.robot import Contact

INERTIA = st.floats(1e-3, 1e3)
MASS = st.floats(0, 1e2)
SPEED = st.floats(0, 10)
VELOCITY = st.floats(-10, 10)
RESTITUTION = st.floats(0, 1)


@given(INERTIA, MASS, VELOCITY, RESTITUTION, VELOCITY)
def test_momentum_and_restitution(inertia, mass, speed, eps, moving):
    """Eq. 1 and 2: nothing is lost but relative speed."""
    robot_after = speed + rebound(inertia, mass, speed, eps, object_velocity=moving)
    object_after = object_speed(inertia, mass, speed, eps, object_velocity=moving)
    momentum = inertia * (speed - robot_after)
    slack = 1e-13 * (inertia + mass) * 10
    assert momentum == pytest.approx(mass * (object_after - moving), abs=slack)
    assert eps * (speed - moving) == pytest.approx(object_after - robot_after, abs=1e-12)


@given(INERTIA, st.floats(1e-3, 1e2), SPEED, RESTITUTION)
def test_equations_as_printed(inertia, mass, speed, eps):
    flux = inertia / (inertia + mass) * speed
    assert hitting_flux(inertia, mass, speed) == pytest.approx(flux, rel=1e-12)
    assert object_speed(inertia, mass, speed, eps) == pytest.approx((1 + eps) * flux, rel=1e-12)
    change = -(1 + eps) * mass / (inertia + mass) * speed
    assert rebound(inertia, mass, speed, eps) == pytest.approx(change, rel=1e-12)


@given(INERTIA, INERTIA, MASS, SPEED)
def test_flux_grows_with_inertia_and_never_exceeds_the_speed(one, other, mass, speed):
    low, high = sorted((one, other))
    assert hitting_flux(low, mass, speed) <= hitting_flux(high, mass, speed) <= speed


@given(st.floats(0.1, 100), st.floats(0.1, 100), st.floats(0.1, 10))
def test_equation_10_as_printed_contradicts_equation_4(inertia, mass, speed):
    """The printed (1 + m_o / lambda) v exceeds the speed, and falls as the inertia grows."""

    def printed(inertia):
        return (1 + mass / inertia) * speed

    assert printed(inertia) > speed >= hitting_flux(inertia, mass, speed)
    assert printed(2 * inertia) < printed(inertia)
    # Its factor is that of the inverse question: the speed a flux needs.
    assert required_speed(inertia, mass, speed) == pytest.approx(printed(inertia), rel=1e-14)


@given(INERTIA, MASS, VELOCITY, VELOCITY)
def test_required_speed_inverts_the_flux(inertia, mass, flux, moving):
    speed = required_speed(inertia, mass, flux, object_velocity=moving)
    again = hitting_flux(inertia, mass, speed, object_velocity=moving)
    assert again == pytest.approx(flux, abs=1e-11)


@given(INERTIA, MASS, VELOCITY, RESTITUTION, VELOCITY, st.floats(-5, 5))
def test_galilean_invariance(inertia, mass, speed, eps, moving, train):
    """Seen from a moving train the hit is the same."""
    given, seen = {"object_velocity": moving}, {"object_velocity": moving + train}
    fast = speed + train
    assert hitting_flux(inertia, mass, fast, **seen) == pytest.approx(
        hitting_flux(inertia, mass, speed, **given), abs=1e-12
    )
    assert rebound(inertia, mass, fast, eps, **seen) == pytest.approx(
        rebound(inertia, mass, speed, eps, **given), abs=1e-12
    )
    assert object_speed(inertia, mass, fast, eps, **seen) == pytest.approx(
        object_speed(inertia, mass, speed, eps, **given) + train, abs=1e-12
    )


def test_hand_numbers():
    assert hitting_flux(3.0, 1.0, 2.0) == 1.5
    assert object_speed(3.0, 1.0, 2.0, 0.5) == 2.25
    assert rebound(3.0, 1.0, 2.0, 0.5) == -0.75
    assert required_speed(3.0, 1.0, 1.5) == 2.0
    assert hitting_flux(3.0, 1.0, 2.0, object_velocity=-2.0) == 3.0
    assert object_speed(3.0, 1.0, 2.0, 0.5, object_velocity=-2.0) == 2.5


def test_immovable_robot_and_weightless_object():
    assert hitting_flux(np.inf, 2.0, 1.5) == 1.5
    assert object_speed(np.inf, 2.0, 1.5, 0.5) == 2.25
    assert required_speed(np.inf, 2.0, 1.5) == 1.5
    assert hitting_flux(4.0, 0.0, 1.5) == 1.5
    for change in (rebound(np.inf, 2.0, 1.5, 0.5), rebound(4.0, 0.0, 1.5, 0.5)):
        assert change == 0
        assert not np.signbit(change)


def test_tiny_inertia_moves_nothing():
    assert rebound(1e-300, 1.0, 2.0, 0.0) == pytest.approx(-2.0)
    assert hitting_flux(1e-300, 1.0, 2.0) == pytest.approx(0.0)


def test_rigid_impact_of_the_whole_arm(arm):
    """The impulse that meets the restitution law, applied to all joints, gives Eq. 3 and 11."""
    robot, mass, eps = arm("iiwa14"), 1.3, 0.7
    rng = np.random.default_rng(8)
    for q in rng.uniform(robot.lower, robot.upper, (30, 7)):
        contact = Contact(int(rng.integers(5, 8)), tuple(rng.uniform(-0.05, 0.05, 3)))
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        qd = rng.normal(size=7)
        pull = h @ jacobian(robot, q, contact)
        arm_and_object = np.zeros((8, 8))
        arm_and_object[:7, :7] = pin.crba(robot.model, robot.model.createData(), q)
        arm_and_object[7, 7] = mass
        gap = np.append(-pull, 1.0)  # speed of the object less that of the contact
        before = np.append(qd, 0.0)
        response = np.linalg.solve(arm_and_object, gap)
        impulse = -(1 + eps) * (gap @ before) / (gap @ response)
        after = before + impulse * response
        inertia, speed = inertia_along(robot, q, contact, h), float(pull @ qd)
        assert object_speed(inertia, mass, speed, eps) == pytest.approx(after[7], rel=1e-10)
        change = pull @ (after[:7] - qd)
        assert rebound(inertia, mass, speed, eps) == pytest.approx(change, rel=1e-10)


def test_broadcasting():
    inertia, mass = np.array([[1.0], [3.0]]), np.array([1.0, 3.0, 9.0])
    flux = hitting_flux(inertia, mass, 2.0)
    np.testing.assert_allclose(flux, [[1, 0.5, 0.2], [1.5, 1, 0.5]])
    assert object_speed(inertia, mass, 2.0, [0, 0.5, 1]).shape == (2, 3)
    assert rebound(inertia, mass, 2.0, 0.5).shape == (2, 3)
    np.testing.assert_allclose(required_speed(inertia, mass, flux), 2.0)
    assert hitting_flux([1.0, 2.0], 1.0, [2.0, 3.0]).tolist() == [1.0, 2.0]
    for scalar in (
        hitting_flux(1, 1, 2),
        object_speed(1, 1, 2, 0),
        rebound(1, 1, 2, 1),
        required_speed(np.float64(1), 1, 2),
    ):
        assert type(scalar) is float


REFUSED = [
    ({"inertia": 0.0}, "inertia = 0.0: it must be above 0 kg"),
    ({"inertia": -2}, "inertia = -2.0: it must be above 0 kg"),
    ({"inertia": np.nan}, "inertia = nan: it must be above 0 kg"),
    ({"inertia": [1.0, -3.0]}, "inertia = -3.0: it must be above 0 kg"),
    ({"inertia": "heavy"}, "inertia = heavy: a number is needed"),
    ({"mass": -0.1}, "mass = -0.1: it must not be below 0 kg"),
    ({"mass": np.inf}, "mass = inf: it must be finite"),
    ({"mass": [1.0, np.nan]}, "mass = nan: it must be finite"),
    ({"mass": "light"}, "mass = light: a number is needed"),
    ({"speed": np.nan}, "speed = nan: it must be finite"),
    ({"object_velocity": -np.inf}, "object_velocity = -inf: it must be finite"),
]


@pytest.mark.parametrize(("wrong", "message"), REFUSED)
def test_refused(wrong, message):
    arguments = {"inertia": 2.0, "mass": 1.0, "speed": 1.0} | wrong
    for ask in (
        hitting_flux,
        lambda **given: object_speed(restitution=0.5, **given),
        lambda **given: rebound(restitution=0.5, **given),
    ):
        with pytest.raises(InputError) as caught:
            ask(**arguments)
        assert str(caught.value) == message
    if "speed" not in wrong:
        arguments["flux"] = arguments.pop("speed")
        with pytest.raises(InputError) as caught:
            required_speed(**arguments)
        assert str(caught.value) == message


@pytest.mark.parametrize("eps", [-0.1, 1.1, np.nan, "elastic", [0.5, 2.0]])
def test_refused_restitution(eps):
    for ask in (object_speed, rebound):
        with pytest.raises(InputError, match="restitution = "):
            ask(2.0, 1.0, 1.0, eps)
    with pytest.raises(InputError, match="flux = nan: it must be finite"):
        required_speed(2.0, 1.0, np.nan)
