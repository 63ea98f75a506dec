"""What is asked again, from the hit that a result keeps, gives the same bits."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.hit_setting import HitSetting, RobotChoice


@pytest.fixture(scope="module")
def hit():
    setting = HitSetting(RobotChoice("iiwa14"), joints=(7,), table_height=0.1, margin=0.005)
    return hj.Hit(None, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, 0.15, setting=setting)


def test_a_hit_planned_and_swung_again_in_one_process_has_the_same_bits(hit):
    first = hj.plan(hit)
    swung = hj.swing(first)
    hj.clearance(first.load_robot(), np.full(7, 0.3), 7, (0, 1, 0), table_height=0.0)
    again = hj.plan(hit)
    assert again == first
    assert hj.swing(again).as_dict() == swung.as_dict()
    assert (hj.swing(again).joints.q == swung.joints.q).all()
