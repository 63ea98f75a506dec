"""Every arm that is known by name goes through every command."""

import tomllib
import warnings

import numpy as np
import pinocchio as pin
import pytest

import hitjoints as hj
from hitjoints.loading.catalogue import ERD, erd_urdfs, robot_file, robot_names
from hitjoints.loading.load import read_robot

NAMES = robot_names()
# What moves in these is no arm, or there is none that a base could hold.
NO_ARM = {
    "a1", "alexander_v1.lowerBodyOnly", "allegro_left_hand", "allegro_right_hand", "anymal", "b1",
    "bolt", "borinot_flying_arm_2", "double_pendulum", "double_pendulum_continuous",
    "double_pendulum_simple", "finger_edu", "go1", "go2", "hextilt_flying_arm_5", "human",
    "hyq_no_sensors", "iris", "iris_simple", "laikago", "quadrotor_base", "quadruped",
    "simple_humanoid", "simple_humanoid_classical", "solo", "solo12", "TwoDofs", "ur3",
}  # fmt: skip
# Another file of an arm that is there.
TWICE = {
    "alex_psyonic_hands", "alex_sake_hands", "g1_29dof_with_hand_rev_1_0", "icub_reduced",
    "panda_collision", "romeo_laas_small", "romeo_small", "talos_full_v2_box", "talos_reduced",
    "talos_reduced_box", "talos_reduced_corrected",
}  # fmt: skip
# The mirror image or a close relative of another, which would only take time.
TWINS = {"iiwa14_bullet", "iiwa7", "ur3", "ur10", "tiago_no_hand", "talos_left_arm", "so100",
         "anymal_kinova"}  # fmt: skip
UNLIKE = [
    name
    for name in NAMES
    if name not in TWINS and not name.endswith(("_right", "_limited", "_gripper"))
]


def file_of(name):
    return tomllib.loads(robot_file(name).read_text())["urdf"]


def test_every_arm_of_example_robot_data_has_a_name():
    used = {file_of(name).rpartition("/")[2].removesuffix(".urdf") for name in NAMES}
    assert set(erd_urdfs()) - used == NO_ARM | TWICE


@pytest.mark.parametrize("name", NAMES)
def test_each_loads_and_stands_well(name):
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        robot = hj.load_robot(name)
    # Three links of the PR2's arms weigh 0.1 kg each, with one tensor.
    expected = ["placeholders" in str(word.message) for word in told]
    assert expected == [True] * name.startswith("pr2")
    facts = tomllib.loads(robot_file(name).read_text())
    assert robot.name == name
    assert robot.source
    assert robot.title
    assert robot.licence
    assert len(robot.hitting_joints) == 3
    assert (robot.velocity_upper > 0).all()
    assert robot.has_mass
    if facts["urdf"].startswith(ERD):
        assert ERD in robot.source
    low, high = robot.finite_limits
    assert (robot.home > low + 0.01).all()
    assert (robot.home < high - 0.01).all()
    # At home the flange can be moved every way: nothing is stretched out.
    jac = pin.computeJointJacobians(robot.model, robot.data, robot.home)
    jac = pin.getFrameJacobian(
        robot.model, robot.data, robot.n, robot.flange.placement, pin.LOCAL_WORLD_ALIGNED
    )
    assert np.linalg.svd(jac[:3], compute_uv=False)[-1] > 0.01
    inertia = hj.directional_inertia(robot, robot.home, robot.usual_joint, [0.3, 0.8, 0.5])
    assert 0 < inertia < 100


@pytest.mark.parametrize("name", NAMES)
def test_no_description_needs_more_than_a_tip(name):
    """What the catalogue adds is comfort: a home, and the torso where it stands."""
    facts = tomllib.loads(robot_file(name).read_text())
    if not facts["urdf"].startswith(ERD):
        return
    stem = facts["urdf"].rpartition("/")[2].removesuffix(".urdf")
    _, arm, robot = read_robot(str(erd_urdfs()[stem]), tip=facts.get("tip"))
    assert arm.tip == facts.get("tip", arm.tip)
    assert robot.n >= hj.load_robot(name).n


def reachable(robot):
    """Return where the usual joint is at home, and a direction that it can move along there."""
    contact = robot.contact(robot.usual_joint)
    at = hj.position(robot, robot.home, contact)
    basis = hj.feasible_directions(robot, robot.home, contact).basis
    return ",".join(map(repr, at.tolist())), ",".join(map(repr, basis[:, 0].tolist()))


@pytest.mark.parametrize("name", UNLIKE)
def test_each_goes_through_every_command(name, run, tmp_path):
    """No traceback: `run` refuses one. The answer may be no, in words."""
    robot = hj.load_robot(name)
    at, along = reachable(robot)
    hit = ("--robot", name, f"--object={at}", f"--direction={along}", "--mass", 1)
    assert run("robots", "check", name, "--json").code == 0
    shown = run("inspect", "--robot", name, f"--direction={along}", "--json")
    assert shown.code == 0
    assert shown.json["inertia"] > 0
    outcomes = [
        run("plan", *hit, "--joint", robot.usual_joint, "--no-certificate", "--no-away", "--json"),
        run("sweep", "joint", *hit, "--joint", robot.usual_joint, "--count", 3, "--json"),
        run("rollout", *hit, "--joint", robot.usual_joint, "--flux", 0.05, "--dt", 0.02, "--json"),
        run("view", "--robot", name, "--out", tmp_path / "view.html", "--json"),
    ]
    for outcome in outcomes:
        assert outcome.code in (0, 3), outcome.err
        assert outcome.code == 0 or outcome.err.startswith(("no: ", "warning: "))
    assert outcomes[0].code == outcomes[1].code == outcomes[3].code == 0


def test_list_shows_where_each_arm_ends(run):
    rows = {row["name"]: row for row in run("robots", "list", "--json").json["robots"]}
    assert sorted(rows) == sorted(NAMES)
    assert rows["panda"]["tip"] == "panda_link8"
    assert rows["tiago_dual_left"]["tip"] == "arm_left_tool_link"
    assert all(row["source"] and row["joints"] >= 5 for row in rows.values())
    words = run("robots", "list").words
    for name in NAMES:
        assert name in words
