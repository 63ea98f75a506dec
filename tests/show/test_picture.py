"""What is drawn in space: the object touches the arm, and what is near hides what is far."""

import coal
import numpy as np
import pytest
from matplotlib.figure import Figure

import hitjoints as hj
from hitjoints.planning.room.shapes import scene_of
from hitjoints.show.arm_faces import arm_faces
from hitjoints.show.drawn_arm import BoxAt
from hitjoints.show.inertia_surface import belted_ellipsoid
from hitjoints.show.picture import Picture
from hitjoints.show.winner_map import TIE, winners


@pytest.mark.parametrize(("name", "joint"), [("iiwa14", 6), ("iiwa14", 7), ("panda", 6)])
def test_the_near_face_of_the_object_is_at_the_surface_of_the_link(arm, name, joint):
    robot = arm(name)
    q, h = robot.home, np.array([0.0, 1.0, 0.0])
    size = np.array([0.002, 0.3, 0.002])  # so thin that it touches with one point
    box = BoxAt.touched(robot, q, robot.contact(joint), h, size)
    here = hj.position(robot, q, joint)
    assert float((box.corners @ h).min()) >= here @ h - 1e-9
    assert box.corners.mean(axis=0) - h * (h @ box.corners.mean(axis=0)) == pytest.approx(
        here - h * (h @ here), abs=1e-9
    )
    scene = scene_of(robot)
    scene.point(q, robot.contact(joint))
    placed = coal.Transform3s(np.eye(3), box.corners.mean(axis=0))
    carriers = [i for i, k in enumerate(scene.links) if k in (joint, joint - 1)]
    assert scene.distance(coal.Box(*size), placed, carriers)[0] == pytest.approx(0, abs=1e-3)


def test_the_faces_are_those_of_the_shapes(arm):
    """They reach as far as Coal says that the shapes do, along any axis."""
    robot = arm("iiwa14")
    corners = np.vstack(arm_faces(robot, robot.home))
    scene = scene_of(robot)
    scene.point(robot.home, robot.flange)
    shapes = list(range(len(scene.links)))
    for axis in (*np.eye(3), *-np.eye(3)):
        beyond = coal.Halfspace(-axis, -5.0)  # what lies 5 m and more along the axis
        far = 5.0 - scene.distance(beyond, coal.Transform3s.Identity(), shapes)[0]
        assert float((corners @ axis).max()) == pytest.approx(far, abs=0.01)


def test_a_face_in_front_is_drawn_last():
    picture = Picture(azimuth=0.0, elevation=0.0)  # seen from +x
    square = np.array([[0.0, -1, -1], [0, 1, -1], [0, 1, 1], [0, -1, 1]])
    picture.solid([np.add(square, (1.0, 0, 0))], "red")
    picture.solid([np.subtract(square, (1.0, 0, 0))], "blue")
    axis = Figure().add_subplot()
    picture.draw(axis)
    colours = axis.collections[0].get_facecolor()
    assert colours[0][2] > colours[0][0]  # blue, far away
    assert colours[1][0] > colours[1][2]
    left, right = axis.get_xlim()
    assert (left, right) == pytest.approx((-1.06, 1.06))


def test_a_picture_is_seen_from_where_it_is_said():
    picture = Picture(azimuth=-90.0, elevation=0.0)  # from -y: x to the right, z up, -y towards us
    assert picture.seen(np.eye(3)) == pytest.approx(
        np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]]), abs=1e-12
    )


def test_the_belted_ellipsoid_is_the_directional_inertia(arm):
    robot = arm("iiwa14")
    q = robot.home
    directions, inertia = belted_ellipsoid(hj.inverse_inertia(robot, q, 6), 7, 8)
    for row, column in ((1, 2), (3, 5), (5, 0)):
        u = directions[row, column]
        assert inertia[row, column] == pytest.approx(hj.directional_inertia(robot, q, 6, u))


def test_winners_and_ties():
    values = np.array([[[1.0, 1.0, np.nan, 2.0]], [[1 - TIE / 2, 0.5, np.nan, np.nan]]])
    first, second = winners(values)
    assert first[0].tolist() == [0, 0, -1, 0]
    assert second[0].tolist() == [1, 0, -1, 0]
    swapped = winners(values[::-1])
    assert swapped[:, 0, 0].tolist() == [0, 1]  # a tie does not ask who is ahead
