"""A swing by servos, its impact and its box's way in one simulation; what the miss is made of."""

import math

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.evidence.physics.whole_hit import CAUSES
from hitjoints.evidence.physics.whole_simulation import simulate_whole


def wanted(**given):
    usual = {"direction": np.array([0, 1, 0]), "mass": 1.0, "flux": 0.4, "restitution": 0.6,
             "friction": 0.25, "size": (0.12, 0.1, 0.1), "yaw": 0.1}  # fmt: skip
    return hj.Hit(6, (0.5, 0.3, 0.5), **(usual | given))


@pytest.fixture(scope="module")
def swung(arm):
    return hj.swing(arm("iiwa14"), wanted())


@pytest.fixture(scope="module")
def slow(swung):
    return simulate_whole(swung)


@pytest.fixture(scope="module")
def quick(swung):
    return simulate_whole(swung, bandwidth=40.0, contact_time=2e-4, support="corners")


def test_quick_servos_and_a_short_contact_bring_the_box_where_it_is_meant(quick):
    assert quick.shares["servo"] < 5e-3 * quick.meant.distance
    assert quick.miss < 0.03 * quick.meant.distance
    assert quick.touch.time == pytest.approx(quick.swing.impact_time, abs=1e-3)
    assert quick.touch.speed == pytest.approx(quick.swing.speed, rel=3e-3)
    assert quick.touch.off_centre == pytest.approx(0, abs=2e-4)
    # Servos that quick push a little in so short a contact, too: the box is faster, never slower.
    assert 1 < quick.left.speed / quick.touched.speed < 1.015
    assert quick.left.spin == pytest.approx(quick.touched.spin, rel=0.02)


def test_the_law_of_sliding_holds_in_it(slow, quick):
    for whole in (slow, quick):
        assert whole.contacts == 1
        assert whole.left_last is whole.left
        assert whole.shares["sliding"] < 3e-3 * whole.meant.distance
        assert math.degrees(whole.rest.yaw - whole.left.yaw) == pytest.approx(0, abs=0.5)


def test_slow_servos_miss_more(slow, quick):
    assert slow.largest_error > 5 * quick.largest_error
    assert slow.shares["servo"] > 5 * quick.shares["servo"]


def test_the_causes_make_the_miss(slow):
    assert tuple(slow.shares) == CAUSES
    whole = slow.rest.place - slow.meant.place
    assert sum(slow.steps.values()) == pytest.approx(whole, abs=1e-12)
    assert sum(slow.along.values()) == pytest.approx(
        whole @ (slow.meant.place - slow.swing.hit.position) / slow.meant.distance, abs=1e-12
    )
    assert set(slow.as_dict()) >= {"meant", "rest", "miss", "shares", "along", "contacts"}


def test_what_it_does_not_know(arm, swung):
    robot = arm("iiwa14")
    with pytest.raises(hj.InputError, match="friction = None"):
        simulate_whole(hj.swing(robot, wanted(friction=None)))
    with pytest.raises(hj.InputError, match=r"direction = .*horizontally"):
        simulate_whole(hj.swing(robot, wanted(direction=np.array([0, 1, -0.2]))))
    with pytest.raises(hj.InputError, match="bandwidth = 0"):
        simulate_whole(swung, bandwidth=0)
