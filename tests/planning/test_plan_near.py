"""Plans near an earlier one: quick, as good as a climb from there can be, and honest about it."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError

AT, H, MASS = np.array([0.5, 0.3, 0.5]), [0.0, 1.0, 0.0], 2.0
QUANTITY = {"inertia": "inertia", "flux": "flux", "straight-flux": "straight_flux"}


@pytest.mark.parametrize("objective", list(QUANTITY))
def test_a_wish_that_moves_is_followed(arm, objective):
    robot = arm("iiwa14")
    options = {"joints": [6], "objective": objective, "certificate": False}
    followed = hj.plan(robot, AT, H, MASS, **options)
    assert not followed.best.evidence["local"]
    for step in range(1, 5):
        at = AT + step * np.array([0.0, 0.004, -0.002])
        followed = hj.plan(robot, at, H, MASS, **options, near=followed)
        whole = hj.plan(robot, at, H, MASS, **options)
        values = [getattr(plan.best, QUANTITY[objective]) for plan in (followed, whole)]
        # Never worse unless it says that it is local; and here the optimum is one and the same.
        assert followed.best.evidence["local"]
        assert values[0] >= values[1] * (1 - 1e-6)
        assert followed.best.position_error <= 1e-6
        assert (robot.lower <= followed.best.q).all()
        assert (followed.best.q <= robot.upper).all()


def test_the_same_wish_has_the_same_answer_and_bits(arm):
    robot = arm("panda")
    first = hj.plan(robot, AT, H, MASS, joints=[6])
    again = [hj.plan(robot, AT, H, MASS, joints=[6], near=first).best for _ in range(2)]
    assert (again[0].q == again[1].q).all()
    assert again[0].inertia >= first.best.inertia * (1 - 1e-9)
    assert again[0].evidence["certificate"]["inertia"] == pytest.approx(again[0].inertia)


def test_a_flux_is_still_demanded(arm):
    robot = arm("iiwa14")
    most = hj.plan(robot, AT, H, MASS, joints=[6], objective="flux").best.flux
    first = hj.plan(robot, AT, H, MASS, joints=[6], flux=0.9 * most)
    near = hj.plan(robot, AT + 0.01, H, MASS, joints=[6], flux=0.9 * most, near=first)
    assert near.best.evidence["local"]
    assert near.best.flux >= 0.9 * most * (1 - 1e-9)
    # Beyond every flux there is nothing near either, and the reason is that of a whole plan.
    none = hj.plan(robot, AT, H, MASS, joints=[6], flux=3 * most, near=first)
    assert none.best is None
    assert "flux" in none.candidates[0].reason


def test_what_the_plan_does_not_have_is_planned_anew(arm):
    robot = arm("iiwa14")
    first = hj.plan(robot, AT, H, MASS, joints=[6], certificate=False)
    near = hj.plan(robot, AT, H, MASS, joints=[6, 7], certificate=False, near=first)
    assert [one.evidence["local"] for one in near.candidates] == [True, False]


def test_a_hit_takes_it_too(arm):
    robot = arm("iiwa14")
    hit = hj.Hit(6, AT, H, MASS)
    first = hj.plan(hit, robot=robot, certificate=False)
    near = hj.plan(hit, robot=robot, certificate=False, near=first)
    assert near.best.evidence["local"]


@pytest.mark.parametrize("wrong", ["other arm", "no plan"])
def test_only_a_plan_of_this_arm_will_do(arm, wrong):
    given = 7 if wrong == "no plan" else hj.plan(arm("panda"), AT, H, MASS, joints=[7])
    with pytest.raises(InputError) as caught:
        hj.plan(arm("iiwa14"), AT, H, MASS, joints=[6], near=given)
    assert caught.value.argument == "near"
