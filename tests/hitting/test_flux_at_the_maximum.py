"""The greatest flux there is can be asked for; what is refused exceeds it in the words, too."""

import re

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InfeasibleError
from hitjoints.hit import Hit
from hitjoints.rollouts.prepare import prepare
from hitjoints.tolerances import told_apart

HIT = ([0.5, 0.3, 0.5], [0.0, 1.0, 0.0], 2.0)


@pytest.mark.parametrize("joint", [6, 7])
def test_a_plans_own_maximum_is_granted_and_more_is_not(joint):
    robot = hj.load_robot("iiwa14")
    best = hj.plan(robot, *HIT, joints=[joint], objective="straight-flux", certificate=False).best
    for share in (1.0 - 1e-12, 1.0, 1.0 + 1e-12, 1.0 + 1e-9):
        found = prepare(robot, Hit(joint, *HIT, share * best.straight_flux), q_hit=best.q)
        np.testing.assert_array_equal(found.q_hit, best.q)
    for share in (1.0 + 2e-6, 1.0001, 1.5):
        with pytest.raises(InfeasibleError, match="beyond the maximum") as caught:
            prepare(robot, Hit(joint, *HIT, share * best.straight_flux), q_hit=best.q)
        wish, most = re.findall(r"([\d.]+) m/s", caught.value.reason)
        assert float(wish) > float(most)
        assert caught.value.data["maximum_flux"] == pytest.approx(best.straight_flux, rel=1e-9)


def test_numbers_are_told_with_the_digits_that_tell_them_apart():
    assert told_apart(1.5, 1.2) == ("1.5", "1.2")
    assert told_apart(1.14000002, 1.14000001) == ("1.14000002", "1.14000001")
    assert told_apart(2.0, 2.0) == ("2", "2")
