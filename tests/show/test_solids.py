"""What an arm looks like: its visual shapes, its collision shapes, or bars."""

import numpy as np
import pinocchio as pin
import pytest
import trimesh

import hitjoints as hj
from hitjoints.show.viewer.solids import THICKNESS, solids, why_bars


@pytest.mark.parametrize("name", ["iiwa14", "iiwa7"])
def test_solids_have_the_volume_of_the_shapes(arm, name):
    robot = arm(name)
    for solid, shape in zip(solids(robot), robot.collision_model.geometryObjects, strict=True):
        drawn = trimesh.Trimesh(solid.vertices, solid.faces)
        # A polygon of 32 sides has 0.64 % less area than its circle.
        assert drawn.volume == pytest.approx(shape.geometry.computeVolume(), rel=0.01)
        box = shape.geometry
        box.computeLocalAABB()
        ends = np.array([box.aabb_local.min_, box.aabb_local.max_])
        np.testing.assert_allclose(drawn.bounds, ends, atol=1e-6 + 0.005 * np.ptp(ends))


def test_spheres_and_boxes_of_an_own_robot(urdf):
    shapes = "".join(
        f'<collision><origin xyz="0.1 0 0"/><geometry>{kind}</geometry></collision>'
        for kind in ('<sphere radius="0.1"/>', '<box size="0.1 0.2 0.3"/>')
    )
    text = urdf.two_links().replace("</inertial></link>", f"</inertial>{shapes}</link>", 1)
    found = solids(urdf.load(text))
    volumes = [trimesh.Trimesh(one.vertices, one.faces).volume for one in found]
    assert [one.joint for one in found] == [1, 1]
    assert volumes == pytest.approx([4 / 3 * np.pi * 0.1**3, 0.006], rel=0.02)


def with_visual(urdf, inside):
    """Return an arm with a box that is checked, and something else that is seen."""
    collision = '<collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision>'
    shapes = f"{collision}<visual>{inside}</visual>"
    return urdf.load(
        urdf.two_links().replace("</inertial></link>", f"</inertial>{shapes}</link>", 1)
    )


def test_visual_shapes_go_before_those_that_are_checked(urdf):
    (seen,) = solids(with_visual(urdf, '<geometry><sphere radius="0.1"/></geometry>'))
    volume = trimesh.Trimesh(seen.vertices, seen.faces).volume
    assert volume == pytest.approx(4 / 3 * np.pi * 0.1**3, rel=0.02)


def test_visual_shapes_that_cannot_be_read_are_left(urdf):
    robot = with_visual(urdf, '<geometry><mesh filename="none.stl"/></geometry>')
    (seen,) = solids(robot)
    assert trimesh.Trimesh(seen.vertices, seen.faces).volume == pytest.approx(0.006)
    assert why_bars(robot) is None


def test_a_visual_mesh_is_welded_and_stays_what_it_is(urdf):
    ball = trimesh.creation.icosphere(subdivisions=2, radius=0.1)
    ball.export(urdf.folder / "ball.stl")
    (seen,) = solids(with_visual(urdf, '<geometry><mesh filename="ball.stl"/></geometry>'))
    assert len(seen.vertices) == len(ball.vertices)  # the file has three for each triangle
    drawn = trimesh.Trimesh(seen.vertices, seen.faces, process=False)
    assert drawn.is_watertight
    assert drawn.volume == pytest.approx(ball.volume, rel=1e-5)


def test_visual_meshes_of_a_known_arm_lie_on_those_that_are_checked(arm):
    """The panda's files are in metres, turned as its URDF says: else they would lie elsewhere."""
    robot = arm("panda")
    seen = {}
    for one in solids(robot):
        points = one.vertices @ one.placement.rotation.T + one.placement.translation
        seen.setdefault(one.joint, []).append(points)
    checked = {}
    for shape in robot.collision_model.geometryObjects:
        shape.geometry.computeLocalAABB()
        box = shape.geometry.aabb_local
        corners = np.array(np.meshgrid(*zip(box.min_, box.max_, strict=True))).reshape(3, -1).T
        placed = corners @ shape.placement.rotation.T + shape.placement.translation
        checked.setdefault(int(shape.parentJoint), []).append(placed)
    for joint in range(1, 8):
        points, corners = np.vstack(seen[joint]), np.vstack(checked[joint])
        np.testing.assert_array_less(corners.min(axis=0) - 0.02, points.min(axis=0))
        np.testing.assert_array_less(points.max(axis=0), corners.max(axis=0) + 0.02)


def test_an_arm_without_shapes_is_drawn_with_bars(urdf):
    robot = urdf.load(urdf.two_links())
    reach = []
    for bar in solids(robot):
        corners = np.asarray(bar.vertices)
        reach += [np.linalg.norm(corners, axis=1).max()]
        assert bar.joint in (0, 1, 2)
    assert max(reach) == pytest.approx(np.hypot(0.3, THICKNESS), rel=1e-6)


def test_faces_stay_within_their_vertices(arm):
    for one in solids(arm("panda")):
        assert one.faces.min() >= 0
        assert one.faces.max() < len(one.vertices)
        assert isinstance(one.placement, pin.SE3)


def test_an_arm_of_pure_shapes_needs_no_bars(arm):
    assert why_bars(hj.load_robot("iiwa14")) is None
