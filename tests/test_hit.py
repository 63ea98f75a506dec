"""The one Hit: what it refuses, what a goal means, and equality."""

import math
import pickle

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError

HERE, ALONG = (0.5, 0.3, 0.5), (0.0, 2.0, 0.0)


def test_direction_has_unit_length_and_cannot_be_written_to():
    hit = hj.Hit(6, HERE, ALONG, 2.0, 0.3)
    assert hit.direction.tolist() == [0, 1, 0]
    assert hit.contact == hj.Contact(6)
    with pytest.raises(ValueError, match="read-only"):
        hit.position[0] = 1.0


def test_a_goal_is_reached_by_a_box_that_slides():
    goal, friction, restitution = (0.9, 0.6, 0.5), 0.35, 0.4
    hit = hj.Hit(7, HERE, mass=1.5, goal=goal, friction=friction, restitution=restitution)
    assert hit.direction == pytest.approx([0.8, 0.6, 0.0])
    # Slide it step by step with the speed of Eq. 3 until friction has stopped it.
    speed, way, dt = (1 + restitution) * hit.desired_flux, 0.0, 1e-6
    while speed > 0:
        way += speed * dt
        speed -= friction * 9.81 * dt
    assert way == pytest.approx(0.5, rel=1e-4)


def test_an_object_speed_gives_the_flux():
    hit = hj.Hit(7, HERE, ALONG, 2.0, object_speed=1.3, restitution=0.3)
    flux = hj.hitting_flux(3.0, 2.0, hit.speed(3.0))
    assert hj.object_speed(3.0, 2.0, hit.speed(3.0), 0.3) == pytest.approx(1.3)
    assert flux == pytest.approx(hit.desired_flux)


@pytest.mark.parametrize(
    ("given", "argument"),
    [
        ({}, "goal"),
        ({"direction": ALONG, "goal": (1, 0.3, 0.5)}, "goal"),
        ({"direction": (0, 0, 0)}, "direction"),
        ({"direction": ALONG, "mass": 0}, "mass"),
        ({"direction": ALONG, "mass": math.nan}, "mass"),
        ({"direction": ALONG, "mass": [1, 2]}, "mass"),
        ({"direction": ALONG, "mass": None}, "mass"),
        ({"direction": ALONG, "flux": -1}, "flux"),
        ({"direction": ALONG, "flux": "hard"}, "flux"),
        ({"direction": ALONG, "flux": 1.0, "object_speed": 1.0}, "object_speed"),
        ({"direction": ALONG, "object_speed": 1.0}, "restitution"),
        ({"goal": (1, 0.3, 0.5), "friction": 0.3}, "restitution"),
        ({"goal": (1, 0.3, 0.5), "restitution": 0.3}, "friction"),
        ({"goal": (1, 0.3, 0.6), "restitution": 0.3, "friction": 0.3}, "goal"),
        ({"goal": HERE, "restitution": 0.3, "friction": 0.3}, "goal"),
        ({"direction": ALONG, "restitution": 1.1}, "restitution"),
        ({"direction": ALONG, "friction": 0}, "friction"),
        ({"direction": ALONG, "size": (0.1, 0.1, 0)}, "size"),
        ({"direction": ALONG, "spread": {"colour": 1}}, "spread"),
        ({"direction": ALONG, "spread": {"mass": -1}}, "spread mass"),
        ({"direction": ALONG, "position": (1, 2)}, "position"),
        ({"direction": ALONG, "position": (1, 2, math.inf)}, "position"),
    ],
)
def test_what_cannot_be_asked_names_the_argument(given, argument):
    with pytest.raises(InputError) as refused:
        hj.Hit(6, **({"position": HERE, "mass": 2.0} | given))
    assert refused.value.argument == argument


def test_equal_when_the_same_is_asked():
    hit = hj.Hit(6, HERE, ALONG, 2.0, 0.3, spread={"mass": 0.1}, size=(0.1, 0.1, 0.2))
    same = hj.Hit(hj.Contact(6), np.array(HERE), (0, 1, 0), 2, 0.3, spread={"mass": 0.1},
                  size=[0.1, 0.1, 0.2])  # fmt: skip
    assert hit == same
    assert hash(hit) == hash(same)
    assert pickle.loads(pickle.dumps(hit)) == hit
    assert hit != hit.with_contact(7)
    assert hit != hit.with_flux(0.4)
    assert hit.with_flux(0.4).desired_flux == 0.4


def test_nothing_chosen_is_said():
    hit = hj.Hit(None, HERE, ALONG, 2.0)
    with pytest.raises(InputError, match="flux"):
        _ = hit.desired_flux
    with pytest.raises(InputError, match="joint"):
        _ = hit.chosen_contact
