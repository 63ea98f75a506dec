from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hitjoints.errors import InputError, ModelError
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact
from hitjoints.planning.room.clearance import clearance
from hitjoints.planning.start import approach_path

LIMIT = '<limit lower="-3" upper="3" velocity="2" effort="3"/>'
X, Z = [1, 0, 0], [0, 0, 1]
TIP = Contact(3, (0.16, 0, 0))


def sphere(radius, at):
    return at, f'<sphere radius="{radius}"/>'


def rod(radius, length, at):
    return at, f'<cylinder radius="{radius}" length="{length}"/>'


def link(name, shape):
    at, geometry = shape
    return (
        f'<link name="{name}"><inertial><mass value="1"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
        f'<collision><origin xyz="{at[0]} {at[1]} {at[2]}"/><geometry>{geometry}</geometry>'
        "</collision></link>"
    )


def joint(i, at, axis="0 1 0"):
    parent = "base" if i == 1 else f"link_{i - 1}"
    return (
        f'<joint name="joint_{i}" type="revolute"><parent link="{parent}"/>'
        f'<child link="link_{i}"/><origin xyz="{at}"/><axis xyz="{axis}"/>{LIMIT}</joint>'
    )


def vertical_arm(*shapes, axes=("0 1 0",) * 3):
    """Three joints about y, 0.5 m apart along x, the first one 1 m above the floor."""
    names = ("base", "link_1", "link_2", "link_3")
    links = "".join(link(*pair) for pair in zip(names, shapes, strict=True))
    places = ("0 0 1", "0.5 0 0", "0.5 0 0")
    joints = "".join(joint(i + 1, at, axes[i]) for i, at in enumerate(places))
    return f'<robot name="small">{links}{joints}</robot>'


SPHERES = {0: (0.1, (0, 0, 0.4)), 1: (0.05, (0.3, 0, 0)), 2: (0.07, (0.25, 0.02, 0)),
           3: (0.06, (0.1, 0, 0))}  # fmt: skip


@pytest.fixture(scope="module")
def balls(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "balls.urdf"
    path.write_text(vertical_arm(*(sphere(*SPHERES[i]) for i in range(4))))
    return load_robot(path)


@pytest.fixture(scope="module")
def rods(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "rods.urdf"
    shapes = [sphere(*SPHERES[i]) for i in range(4)]
    shapes[2] = rod(0.04, 0.2, (0.25, 0, 0))
    path.write_text(vertical_arm(*shapes))
    return load_robot(path)


def centre(q, i):
    """Position of the middle of link i's sphere, by hand: rotations about y add up."""
    radius, at = SPHERES[i]
    if i == 0:
        return np.array(at), radius
    here, angle = np.array([0.0, 0, 1]), 0.0
    for k in range(1, i + 1):
        here = here + (rotated(angle, (0.5, 0, 0)) if k > 1 else 0)
        angle += q[k - 1]
    return here + rotated(angle, at), radius


def rotated(angle, v):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([c * v[0] + s * v[2], v[1], -s * v[0] + c * v[2]])


def gap(q, i, j):
    (a, r), (b, s) = centre(q, i), centre(q, j)
    return np.linalg.norm(a - b) - r - s


angles = st.tuples(*[st.floats(-3, 3)] * 3).map(np.array)


@settings(max_examples=60)
@given(q=angles)
def test_spheres_by_hand(balls, q):
    found = clearance(balls, q, 3, X, table_height=0.2)
    itself = {pair: gap(q, *pair) for pair in ((0, 2), (0, 3), (1, 3))}
    assert found.itself == pytest.approx(min(itself.values()), abs=1e-6)
    heights = {i: centre(q, i)[0][2] - centre(q, i)[1] - 0.2 for i in (1, 2, 3)}
    assert found.table == pytest.approx(min(heights.values()), abs=1e-6)
    assert found.object == np.inf
    assert found.least == min(found.itself, found.table)


def test_rods_and_the_names_of_what_is_closest(rods):
    found = clearance(rods, np.zeros(3), TIP, X, [0.2, 0.4, 0.6], 0.5)
    assert found.table == pytest.approx(1 - 0.1 - 0.5, abs=1e-6)
    assert found.object == pytest.approx(0.1 + 0.06 - (-0.25 + 0.04), abs=1e-6)
    assert found.closest["table"] == ("link_2", "table")
    assert found.closest["object"] == ("link_2", "object")


def test_penetration_is_negative(rods):
    down = clearance(rods, [np.pi / 2, 0, 0], 3, X, table_height=0.5)
    assert down.table == pytest.approx(1 - 1.1 - 0.06 - 0.5, abs=1e-6)


def test_the_box_lies_ahead_of_the_surface_around_the_origin_of_a_joint(balls):
    # Ahead of joint 3's origin link 3's sphere ends at 1.16 m; links 2 and 3 carry the point.
    found = clearance(balls, np.zeros(3), 3, X, [0.2, 0.2, 0.2])
    assert found.object == pytest.approx(1.16 - 0.35, abs=1e-4)
    assert found.closest["object"] == ("link_1", "object")


def test_an_oblique_box_touches_the_contact_with_its_surface(balls):
    # Its half extent along the diagonal is 0.1 sqrt 2, so a corner edge points at the arm.
    h = np.array([1, 0, 1]) / np.sqrt(2)
    found = clearance(balls, np.zeros(3), Contact(3, (0.3, 0, 0)), h, [0.2, 0.2, 0.2])
    corner = np.array([1.3, 0, 1]) + 0.1 * np.sqrt(2) * h - np.array([0.1, 0, 0.1])
    expected = np.linalg.norm(corner - centre(np.zeros(3), 2)[0] + [0, 0.02, 0]) - 0.07
    assert found.object == pytest.approx(expected, abs=1e-6)


def test_a_path_counts_with_its_worst_row_and_the_object_stays(balls):
    path = np.linspace([0.6, -1.2, 0.8], [0.2, -0.9, 0.3], 5)
    whole = clearance(balls, path, TIP, X, [0.3, 0.3, 0.3], 0.2)
    rows = [clearance(balls, q, TIP, X, [0.3, 0.3, 0.3], 0.2) for q in path]
    assert whole.itself == min(row.itself for row in rows)
    assert whole.table == min(row.table for row in rows)
    assert whole.object <= rows[-1].object


def test_the_approach_is_the_path_that_leads_there(balls):
    q = np.array([0.4, -1.2, 0.5])
    found = clearance(balls, q, TIP, X, [0.3, 0.3, 0.3], 0.2, approach=0.2)
    path, reason = approach_path(balls, q, balls.contact(TIP), X, 0.2)
    assert not reason
    assert found.approach == pytest.approx(0.2, abs=1e-4)
    by_path = clearance(balls, path, TIP, X, [0.3, 0.3, 0.3], 0.2)
    assert found.least == by_path.least


def test_an_approach_that_ends_early_says_so(balls):
    found = clearance(balls, [0.3, -0.6, 0.3], TIP, [-1, 0, 0], approach=1.0)
    assert 0 < found.approach < 0.5


def test_links_that_turn_about_the_vertical_are_not_measured_from_the_table(urdf):
    shapes = [sphere(*SPHERES[i]) for i in range(4)]
    shapes[1] = sphere(0.5, (0, 0, 0))
    robot = urdf.load(vertical_arm(*shapes, axes=("0 0 1", "0 1 0", "0 1 0")))
    found = clearance(robot, np.zeros(3), 3, X, table_height=0.2)
    assert found.table == pytest.approx(1 - 0.07 - 0.2, abs=1e-6)


@pytest.mark.parametrize("name", ["panda", "xarm7"])
def test_meshes_stand_on_their_lowest_vertex(arm, name):
    robot, lowest = arm(name), np.inf
    q = robot.home + 0.2
    placed, data = pin.GeometryData(robot.collision_model), robot.model.createData()
    pin.updateGeometryPlacements(robot.model, data, robot.collision_model, placed, q)
    for shape, where in zip(robot.collision_model.geometryObjects, placed.oMg, strict=True):
        if shape.parentJoint > 1 and hasattr(shape.geometry, "vertices"):
            vertices = shape.geometry.vertices() @ where.rotation.T + where.translation
            lowest = min(lowest, vertices[:, 2].min())
    found = clearance(robot, q, 6, [0, 1, 0], table_height=0.0)
    assert found.table <= lowest + 1e-6
    if name == "xarm7":  # the panda's fingers have boxes, and may be lower
        assert found.table == pytest.approx(lowest, abs=1e-6)


def test_links_built_close_to_each_other_do_not_count(arm):
    # Links 5 and 7 of the iiwa are 2 cm apart at most, whatever the arm does.
    robot = arm("iiwa14")
    assert clearance(robot, robot.home, 7, [0, 1, 0]).itself > 0.1


def test_threads_agree(arm):
    robot = arm("iiwa14")
    rows = np.random.default_rng(3).uniform(robot.lower, robot.upper, (40, 7))

    def least(q):
        return clearance(robot, q, 6, [0, 1, 0], [0.2, 0.2, 0.2], 0.1).least

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(least, rows)) == [least(q) for q in rows]


def test_an_arm_without_shapes(urdf):
    with pytest.raises(ModelError, match="no collision shapes"):
        clearance(urdf.load(urdf.two_links()), [0, 0], 2, X)


@pytest.mark.parametrize(
    ("argument", "change"),
    [
        ("object_size", {"object_size": [0.1, 0.1]}),
        ("object_size", {"object_size": [0.1, 0.0, 0.1]}),
        ("table_height", {"table_height": np.nan}),
        ("approach", {"approach": -0.1}),
        ("direction", {"direction": [0, 0, 0]}),
        ("direction", {"direction": [[1, 0, 0], [0, 1, 0]]}),
        ("joint", {"contact": 4}),
        ("q", {"q": [0, 0]}),
    ],
)
def test_bad_arguments_are_named(balls, argument, change):
    given = {"q": np.zeros(3), "contact": 3, "direction": X} | change
    with pytest.raises(InputError) as caught:
        clearance(balls, **given)
    assert caught.value.argument == argument
