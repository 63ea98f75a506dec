"""A robot, a hit or a plan as the first argument, positional or by its name."""

import pytest

import hitjoints as hj


def test_the_first_argument_may_be_named():
    robot = hj.load_robot("iiwa14")
    given = {"position": [0.5, 0.3, 0.5], "direction": [0, 1, 0], "mass": 2.0}
    settings = {"joints": [6], "certificate": False}
    by_place = hj.plan(robot, *given.values(), **settings)
    by_name = hj.plan(robot=robot, **given, **settings)
    assert by_name.best.q == pytest.approx(by_place.best.q)
    hit = hj.Hit(6, **given, flux=0.2)
    by_hit = hj.plan(hit=hit, robot=robot)
    assert by_hit.best.joint == 6
    assert hj.rollout(robot=robot, hit=hit, dt=0.01).impact.flux > 0


def test_none_at_all_is_a_type_error():
    with pytest.raises(TypeError):
        hj.plan()
