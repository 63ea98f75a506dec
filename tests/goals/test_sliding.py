"""Sliding boxes against closed forms, an integrator of its own, and MuJoCo."""

import math

import numpy as np
import pytest

from hitjoints.errors import InputError, UnknownNameError
from hitjoints.goals.sliding import slide_to_rest
from tests.oracles.mujoco_box import let_go

SIZE, MU, G = (0.2, 0.15, 0.12), 0.3, 9.81


def step_by_step(velocity, spin, size, mu, support, dt=1e-4, cells=20):
    """Slide one box by Euler steps over a fine grid, the pressure's centre found by iteration."""
    a, b, up = (edge / 2 for edge in size)
    if support == "corners":
        x, y = (grid.ravel() for grid in np.meshgrid([-a, a], [-b, b]))
    else:
        at = (np.arange(cells) + 0.5) / cells * 2 - 1
        x, y = (grid.ravel() for grid in np.meshgrid(a * at, b * at))
    v, w, where, yaw = np.array(velocity, float), float(spin), np.zeros(2), 0.0
    spin_inertia = (size[0] ** 2 + size[1] ** 2) / 12
    force = np.zeros(2)
    while math.hypot(*v) + math.sqrt(spin_inertia) * abs(w) > 5e-4:
        c, s = math.cos(yaw), math.sin(yaw)
        turn = np.array([[c, s], [-s, c]])
        u = turn @ v
        slip = np.stack([u[0] - w * y, u[1] + w * x])
        slip /= np.maximum(np.hypot(*slip), 1e-12)
        for _ in range(6):  # weight and friction balance about the centre of mass
            shift = -up * force / G
            load = 1 + shift[0] * x / np.mean(x**2) + shift[1] * y / np.mean(y**2)
            force = -mu * G * np.mean(load * slip, axis=1)
        moment = -mu * G * np.mean(load * (x * slip[1] - y * slip[0]))
        where = where + dt * v
        yaw += dt * w
        v = v + dt * turn.T @ force
        w += dt * moment / spin_inertia
    return where, yaw


@pytest.mark.parametrize("support", ["face", "corners"])
@pytest.mark.parametrize(("velocity", "spin"), [((0.8, 0.3), 6.0), ((0.4, 0.0), -8.0)])
def test_agrees_with_small_steps(support, velocity, spin):
    where, yaw = step_by_step(velocity, spin, SIZE, MU, support)
    found = slide_to_rest([velocity], spin, SIZE, MU, support=support)
    assert found.displacement[0] == pytest.approx(where, abs=2e-3 * np.linalg.norm(where) + 1e-4)
    assert found.yaw[0] == pytest.approx(yaw, rel=5e-3)


def test_without_spin_the_way_is_that_of_a_point():
    found = slide_to_rest([[1.2, 0.0], [0.0, -0.4]], 0.0, SIZE, [0.3, 0.6], yaw=0.4)
    assert np.linalg.norm(found.displacement, axis=1) == pytest.approx(
        [1.2**2 / (2 * 0.3 * G), 0.4**2 / (2 * 0.6 * G)], rel=1e-5
    )
    assert found.yaw == pytest.approx([0, 0], abs=1e-9)
    assert found.time == pytest.approx([1.2 / (0.3 * G), 0.4 / (0.6 * G)], rel=2e-3)


@pytest.mark.parametrize(
    ("support", "arm"),
    [("corners", 0.5 * math.sqrt(2)), ("face", (math.sqrt(2) + math.asinh(1)) / 6)],
)
def test_a_turning_square_is_stopped_by_its_mean_radius(support, arm):
    edge, spin = 0.2, 9.0
    found = slide_to_rest([[0.0, 0.0]], spin, (edge, edge, 0.1), MU, support=support)
    assert found.yaw[0] == pytest.approx(spin**2 * edge / (12 * MU * G * arm), rel=5e-3)


@pytest.mark.parametrize(("velocity", "spin"), [((1.0, 0.0), 0.0), ((0.8, 0.3), 4.0)])
def test_agrees_with_mujoco_by_corners(velocity, spin):
    where, yaw = let_go(SIZE, velocity, spin, MU)
    found = slide_to_rest([velocity], spin, SIZE, MU, support="corners")
    distance = np.linalg.norm(where)
    assert np.linalg.norm(found.displacement[0]) == pytest.approx(distance, rel=1e-2)
    apart = (
        where[0] * found.displacement[0, 1] - where[1] * found.displacement[0, 0]
    ) / distance**2
    assert abs(math.degrees(apart)) < 2
    assert math.degrees(found.yaw[0] - yaw) == pytest.approx(0, abs=3)


def test_the_path_of_a_turning_box_curls_to_the_side_its_front_turns_to():
    left = slide_to_rest([[1.0, 0.0]], 5.0, SIZE, MU).displacement[0, 1]
    right = slide_to_rest([[1.0, 0.0]], -5.0, SIZE, MU).displacement[0, 1]
    assert left == pytest.approx(-right)
    assert left < -1e-3


def test_what_rests_stays():
    found = slide_to_rest(np.zeros((2, 2)), 0.0, SIZE, MU)
    assert not found.displacement.any()
    assert not found.time.any()


@pytest.mark.parametrize(
    ("size", "friction", "support", "argument"),
    [
        ((0.1, 0.1, 0), 0.3, "face", "size"),
        ((0.1, 0.1), 0.3, "face", "size"),
        (SIZE, 0, "face", "friction"),
        (SIZE, math.nan, "face", "friction"),
    ],
)
def test_bad_input_names_the_argument(size, friction, support, argument):
    with pytest.raises(InputError) as refused:
        slide_to_rest([[1.0, 0.0]], 0.0, size, friction, support=support)
    assert refused.value.argument == argument


def test_an_unknown_support_lists_the_known_ones():
    with pytest.raises(UnknownNameError, match="corners, face"):
        slide_to_rest([[1.0, 0.0]], 0.0, SIZE, MU, support="feet")
