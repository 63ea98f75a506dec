"""Off-centre hits against the impulses of constrained rigid bodies, solved as linear equations."""

import numpy as np
import pytest

from hitjoints.errors import InfeasibleError
from hitjoints.goals.box_hit import Boxes, hit_boxes

SIZE = np.array([0.2, 0.15, 0.12])


def boxes(mass=1.3, yaw=0.0, offset=0.0, height=0.0, friction=0.3, support="corners"):
    return Boxes(np.array([mass]), SIZE, np.array([yaw]), np.array([offset]), height,
                 np.array([friction]), support)  # fmt: skip


def by_constraints(mass, yaw, offset, height, friction, inertia, speed, restitution):
    """Return centre velocity (3,), spin (3,) of a box after the hit, in the face's axes.

    Unknowns: the box's six velocities, the hammer's one, the hit's impulse and those of the two
    corners that are pressed down, which slip against friction: found by going round.
    """
    length, width, up = SIZE
    tensor = mass / 12 * np.diag([width**2 + up**2, length**2 + up**2, length**2 + width**2])
    # Where the line of the hit meets the face, by intersecting the two.
    normal, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    t = (-length / 2 - normal @ [0, offset]) / (normal @ [1, 0])
    contact = np.array([-length / 2, across @ np.array([t, offset]), height])
    ahead = np.sign(height) * length / 2
    corners = [np.array([ahead, side * width / 2, -up / 2]) for side in (-1, 1)]
    push, slips = np.array([1.0, 0, 0]), [np.array([1.0, 0, 0])] * 2
    for _ in range(200):
        A, b = np.zeros((10, 10)), np.zeros(10)
        A[:3, :3], A[3:6, 3:6] = mass * np.eye(3), tensor
        A[:3, 7], A[3:6, 7] = -push, -np.cross(contact, push)
        A[6, 6], A[6, 7], b[6] = inertia, 1.0, inertia * speed * np.cos(yaw)
        A[7, :3], A[7, 3:6], A[7, 6] = push, np.cross(contact, push), -1
        b[7] = restitution * speed * np.cos(yaw)
        for i, (corner, slip) in enumerate(zip(corners, slips, strict=True)):
            hold = np.array([0, 0, 1.0]) - friction * slip
            A[:3, 8 + i], A[3:6, 8 + i] = -hold, -np.cross(corner, hold)
            if height:
                A[8 + i, :3], A[8 + i, 3:6] = [0, 0, 1], np.cross(corner, [0, 0, 1])
            else:
                A[8 + i, 8 + i] = 1
        x = np.linalg.solve(A, b)
        slips = [x[:3] + np.cross(x[3:6], corner) for corner in corners]
        slips = [slip / np.linalg.norm(slip) for slip in slips]
    assert not height or (x[8:] > 0).all()
    return x[:3], x[3:6], x[7]


@pytest.mark.parametrize("seed", range(12))
def test_agrees_with_constrained_bodies(seed):
    rng = np.random.default_rng(seed)
    given = {
        "mass": rng.uniform(0.2, 5), "yaw": rng.uniform(-0.35, 0.35),
        "offset": rng.uniform(-0.02, 0.02), "height": rng.uniform(-0.02, 0.02),
        "friction": rng.uniform(0.1, 0.6),
    }  # fmt: skip
    inertia, speed, restitution = rng.uniform(1, 10), rng.uniform(0.2, 0.6), rng.uniform(0, 1)
    found = hit_boxes(
        boxes(**given), np.array([inertia]), np.array([speed]), np.array([restitution])
    )
    velocity, spin, impulse = by_constraints(
        **given, inertia=inertia, speed=speed, restitution=restitution
    )
    assert found.impulse[0] == pytest.approx(impulse, rel=1e-9)
    cos, sin = np.cos(given["yaw"]), np.sin(given["yaw"])
    ahead = np.array([[cos, -sin], [sin, cos]]) @ velocity[:2]
    assert found.velocity[0] == pytest.approx(ahead, rel=1e-9)
    assert found.spin[0] == pytest.approx(spin[2], rel=1e-9)


def test_an_edge_that_would_slip_back_sticks():
    """Hit so high, the box turns about its edge as about a hinge."""
    mass, friction, height = 1.3, 0.5, 0.08
    length, _, up = size = (0.1, 0.15, 0.2)
    one = np.ones(1)
    box = Boxes(mass * one, np.array(size), 0 * one, 0 * one, height, friction * one)
    hinge = mass / 12 * (length**2 + up**2) + mass / 4 * (length**2 + up**2)
    pitch = (height + up / 2) / hinge
    along, lift = mass * pitch * up / 2, mass * pitch * length / 2
    assert abs(1 - along) < friction * lift  # what friction has to bear, and may
    assert box.response.pitch == pytest.approx([pitch], rel=1e-6)
    assert box.response.velocity[0] == pytest.approx([pitch * up / 2, 0], rel=1e-6, abs=1e-9)


def test_a_central_hit_is_that_of_the_paper():
    found = hit_boxes(boxes(mass=2.0), np.array([3.0]), np.array([0.8]), np.array([0.4]))
    assert found.velocity[0] == pytest.approx([1.4 * 3 / 5 * 0.8, 0])
    assert found.spin == pytest.approx([0])


@pytest.mark.parametrize(
    ("given", "speed", "words"),
    [
        ({"offset": 0.09}, 0.3, "misses the face"),
        ({"height": 0.06}, 6.0, "tip"),
        ({"friction": 1.5}, 0.3, "slide on its edge"),
    ],
)
def test_a_box_that_does_not_simply_slide_is_refused_in_words(given, speed, words):
    with pytest.raises(InfeasibleError, match=words):
        hit_boxes(boxes(**given), np.array([3.0]), np.array([speed]), np.array([0.5]))
