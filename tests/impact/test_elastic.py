"""`elastic_impact`: the arm at its border, what it returns, and what it refuses."""

import numpy as np
import pytest

import hitjoints as hj

H = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def arm():
    return hj.load_robot("iiwa14")


def hit(arm, **given):
    asked = {
        "robot": arm, "q": arm.home, "contact": 7, "direction": H, "mass": 0.4, "speed": 0.8,
        "restitution": 0.5, "contact_time": 0.005, "stiffness": 1e4,
    } | given  # fmt: skip
    return hj.elastic_impact(**asked)


def test_balance_and_equivalent(arm):
    one = hit(arm)
    assert one.impulse == pytest.approx(0.4 * one.object_speed, rel=1e-14)
    assert one.shown == pytest.approx(one.impulse / (0.8 - one.robot_speed), rel=1e-14)
    again = hj.object_speed(one.equivalent, 0.4, 0.8, 0.5)
    assert again == pytest.approx(one.object_speed, rel=1e-12)


def test_speeds_are_proportional_and_times_and_inertias_are_not(arm):
    slow, fast = hit(arm), hit(arm, speed=1.6)
    assert fast.object_speed == pytest.approx(2 * slow.object_speed, rel=1e-12)
    for name in ("contact_time", "shown", "equivalent"):
        assert getattr(fast, name) == pytest.approx(getattr(slow, name), rel=1e-9)


def test_the_longer_the_contact_the_more_of_the_arm_takes_part(arm):
    times = (1e-5, 1e-3, 3e-3, 5e-3, 1e-2, 2e-2)
    shown = [hit(arm, contact_time=time).equivalent for time in times]
    assert (np.diff(shown) > 0).all()
    assert shown[0] == pytest.approx(hj.directional_inertia(arm, arm.home, 7, H), rel=1e-4)
    assert shown[-1] < hj.impact_inertia(arm, arm.home, 7, H, "rotor")


def test_what_is_not_given_is_the_robots_or_assumed(arm):
    assert arm.joint_stiffness is None
    assert hit(arm, stiffness=None).object_speed == hit(arm).object_speed
    assert hit(arm, rotor_inertia=arm.rotor_inertia) == hit(arm)
    assert hit(arm, rotor_inertia=0.0).equivalent == pytest.approx(
        hj.directional_inertia(arm, arm.home, 7, H), rel=1e-7
    )


def test_servos_push(arm):
    free, held = hit(arm, contact_time=0.02), hit(arm, contact_time=0.02, servo=(0.0, 500.0))
    assert held.object_speed > free.object_speed
    assert hit(arm, servo=(0.0, 0.0)) == hit(arm)


def test_an_object_faster_than_any_inertia_makes_it(arm):
    strong = hit(arm, mass=4.0, restitution=0.05, contact_time=0.05, servo=(1e5, 1e3))
    assert strong.object_speed > 1.05 * 0.8
    assert strong.equivalent is None


def test_a_contact_given_as_a_spring(arm):
    by_time = hit(arm)
    mobility = 1 / hj.directional_inertia(arm, arm.home, 7, H)
    from hitjoints.impact.elastic import pair_spring

    spring = pair_spring(mobility, 0.4, 0.5, 0.005)
    assert hit(arm, spring=spring).object_speed == pytest.approx(by_time.object_speed, rel=1e-12)
    assert hit(arm, spring=(2 * spring[0], spring[1])).contact_time < by_time.contact_time


def test_as_a_dictionary(arm):
    names = {
        "object_speed", "robot_speed", "contact_time", "impulse", "shown", "equivalent",
        "second_contact",
    }  # fmt: skip
    found = hit(arm).as_dict()
    assert set(found) == names
    assert all(value is None or type(value) is float for value in found.values())


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"mass": 0.0}, "mass = 0"),
        ({"mass": np.inf}, "mass = inf"),
        ({"speed": -1.0}, "speed = -1"),
        ({"restitution": 1.2}, "restitution = 1.2"),
        ({"contact_time": np.nan}, "contact_time = nan"),
        ({"stiffness": 0.0}, "stiffness = 0"),
        ({"stiffness": [1e4, 1e4]}, "stiffness = "),
        ({"damping": -1.0}, "damping = -1"),
        ({"servo": (-1.0, 0.0)}, "servo = -1"),
        ({"servo": 3.0}, "servo = 3"),
        ({"spring": (0.0, 0.0)}, "spring = "),
        ({"direction": [H, H]}, "direction = 2 rows"),
        ({"contact": 9}, "joint = 9"),
        ({"contact": 1, "direction": (0, 0, 1)}, "infeasible direction"),
    ],
)
def test_what_cannot_be_used_is_named(arm, given, said):
    with pytest.raises(hj.HitjointsError) as caught:
        hit(arm, **given)
    assert str(caught.value).startswith(said)


def test_motors_that_are_not_known():
    arm = hj.load_robot("xarm7")
    with pytest.raises(hj.ModelError, match="rotor_inertia"):
        hit(arm, q=arm.home, contact=5)
