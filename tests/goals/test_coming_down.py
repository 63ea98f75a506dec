"""Boxes that pitched come down: against small steps in the plane, and what must hold anyway."""

import numpy as np
import pytest

from hitjoints.errors import InfeasibleError
from hitjoints.goals.box_hit import Boxes, hit_boxes
from hitjoints.goals.coming_down import come_down
from hitjoints.goals.leaning import Response

G = 9.81


def box(size, height, friction, support="face"):
    one = np.ones(1)
    return Boxes(1.3 * one, np.array(size), 0 * one, 0 * one, height, friction * one, support)


def pitched(speed, pitch):
    return Response(np.array([[speed, 0.0]]), np.zeros(1), np.array([pitch]))


def step_by_step(size, side, friction, speed, pitch, dt=2e-6):
    """Return way, speed, and whether it rocks on, when the other edge has struck: small steps."""
    a, d, inertia = size[0] / 2, size[2] / 2, (size[0] ** 2 + size[2] ** 2) / 12
    lift, rate, x, v = 0.0, side * pitch, 0.0, speed
    while True:
        reach, down = a * np.cos(lift) - d * np.sin(lift), d * np.cos(lift) + a * np.sin(lift)
        turn = (side * friction * down - reach) / inertia  # by a load of 1 per mass
        load = (G - down * rate**2) / (1 - reach * turn)
        lift, rate = lift + dt * rate + dt**2 / 2 * load * turn, rate + dt * load * turn
        x, v = x + dt * v - dt**2 / 2 * friction * load, v - dt * friction * load
        if lift < 0:
            break
        assert reach > 0
    # The far edge alone stops: does the near one rise, or sink?
    turn = (a + side * friction * d) / inertia
    shock = -2 * a * rate / (1 + a * turn)
    after, rise = rate + shock * turn, a * rate + shock
    if rise - a * after > 0:
        return x, v - friction * shock, -after
    return x, v - friction * -a * rate, 0.0


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("size", "pitch", "friction"),
    [((0.2, 0.15, 0.12), 1.5, 0.3), ((0.1, 0.1, 0.1), 2.5, 0.2), ((0.1, 0.1, 0.19), 0.6, 0.15)],
)
def test_agrees_with_small_steps_until_it_is_down(monkeypatch, side, size, pitch, friction):
    monkeypatch.setattr("hitjoints.goals.coming_down.ROCKS", 1)
    way, speed, rocking = step_by_step(size, side, friction, 1.5, side * pitch)
    down = come_down(box(size, side * 0.01, friction), pitched(1.5, side * pitch))
    assert down.way[0] == pytest.approx([way, 0], rel=1e-4)
    assert down.moved.velocity[0] == pytest.approx([speed, 0], rel=1e-4)
    assert down.side[0] * down.moved.pitch[0] == pytest.approx(rocking, rel=1e-3)
    assert (rocking > 0) == (size[2] > 0.15)


@pytest.mark.parametrize("height", [0.02, -0.02])
def test_in_the_end_the_table_has_carried_the_weight(height):
    """What friction did not take while the box was up, it takes when the box comes down."""
    boxes = box((0.2, 0.15, 0.12), height, 0.3)
    left = hit_boxes(boxes, np.array([3.0]), np.array([1.0]), np.array([0.5]))
    down = left.down
    whole = left.impulse / boxes.mass
    lost = whole[0] - down.moved.velocity[0, 0]
    time = lost / (0.3 * G)
    # By the same deceleration all along, up to second order:
    assert down.way[0, 0] == pytest.approx(whole[0] * time - 0.3 * G * time**2 / 2, rel=2e-3)
    assert left.velocity[0, 0] < whole[0]


def test_a_box_hit_in_the_middle_of_its_height_is_down_already():
    moved = pitched(1.0, 0.0)
    down = come_down(box((0.2, 0.15, 0.12), 0.0, 0.3), moved)
    assert down.moved is moved
    assert not down.way.any()


def test_boxes_are_followed_each_for_itself():
    many = [(0.3, 1.5), (0.2, 0.0), (0.5, 2.0)]
    one = np.ones(3)
    boxes = Boxes(one, np.array([0.2, 0.15, 0.12]), 0 * one, 0 * one, 0.01,
                  np.array([friction for friction, _ in many]))  # fmt: skip
    moved = Response(np.array([[1.0, 0.1]] * 3), one, np.array([pitch for _, pitch in many]))
    down = come_down(boxes, moved)
    for i, (friction, pitch) in enumerate(many):
        alone = Boxes(one[:1], boxes.size, 0 * one[:1], 0 * one[:1], 0.01, np.array([friction]))
        single = come_down(alone, Response(np.array([[1.0, 0.1]]), one[:1], np.array([pitch])))
        assert single.way[0] == pytest.approx(down.way[i], rel=1e-12)
        assert single.yaw[0] == pytest.approx(down.yaw[i], rel=1e-12)


@pytest.mark.parametrize(("share", "tips"), [(0.97, False), (1.03, True)])
def test_a_box_tips_by_energy_where_there_is_no_friction(share, tips):
    size = np.array([0.1, 0.1, 0.15])
    half, up = size[0] / 2, size[2] / 2
    # The edge slips freely: the centre moves up and down only, so that its own inertia counts.
    rate = np.sqrt(
        2 * G * (np.hypot(half, up) - up) / ((size[0] ** 2 + size[2] ** 2) / 12 + half**2)
    )
    down = come_down(box(size, 0.01, 1e-9), pitched(1.0, share * rate))
    assert down.tipped[0] == tips


def test_friction_at_the_edge_helps_to_tip():
    size = (0.08, 0.12, 0.2)
    given = np.array([3.0]), np.array([0.45]), np.array([0.4])
    hit_boxes(box(size, 0.03, 0.05), *given)
    with pytest.raises(InfeasibleError, match="tip over"):
        hit_boxes(box(size, 0.03, 0.29), *given)
