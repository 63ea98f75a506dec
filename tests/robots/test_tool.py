"""A tool is the link that a URDF would say, and its tip hits."""

import json
import pickle

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.loading.load import load_robot
from hitjoints.model.tool import Tool

HAMMER = {
    "mass": 0.8,
    "com": [0.01, -0.02, 0.07],
    "inertia": [[2e-3, 1e-4, 0], [1e-4, 1.8e-3, 2e-4], [0, 2e-4, 6e-4]],
    "tip": [0.03, 0.01, 0.15],
}
TOML = """mass = 0.8
com = [0.01, -0.02, 0.07]
inertia = [[2e-3, 1e-4, 0], [1e-4, 1.8e-3, 2e-4], [0, 2e-4, 6e-4]]
tip = [0.03, 0.01, 0.15]
"""
WRITTEN = """<link name="hammer"><inertial><origin xyz="0.01 -0.02 0.07"/><mass value="0.8"/>
<inertia ixx="2e-3" iyy="1.8e-3" izz="6e-4" ixy="1e-4" ixz="0" iyz="2e-4"/></inertial></link>
<joint name="grip_hammer" type="fixed"><parent link="{flange}"/><child link="hammer"/></joint>
<link name="head_tool0"/><joint name="head" type="fixed"><origin xyz="0.03 0.01 0.15"/>
<parent link="hammer"/><child link="head_tool0"/></joint></robot>"""
FLANGES = {"iiwa14": "flange", "panda": "panda_link8", "xarm7": "link_eef", "ur5_robot": "tool0"}
H = np.array([0.6, 0.0, 0.8])


@pytest.mark.parametrize("name", FLANGES)
def test_inertia_is_that_of_the_tool_written_into_the_urdf(arm, name):
    bare = arm(name)
    written = load_robot(bare.xml.replace("</robot>", WRITTEN.format(flange=FLANGES[name])))
    held = load_robot(name, tool=HAMMER)
    tip = held.flange
    q = np.random.default_rng(0).uniform(-2, 2, (20, held.n))
    for contact in (4, held.n - 1, tip):
        mine, theirs = (hj.directional_inertia(r, q, contact, H) for r in (held, written))
        np.testing.assert_allclose(mine, theirs, rtol=1e-12)
    for row in q[:5]:
        frame = written.model.getFrameId("head_tool0")
        import pinocchio as pin

        pin.framesForwardKinematics(written.model, written.data, row)
        there = written.data.oMf[frame].translation
        np.testing.assert_allclose(hj.position(held, row, tip), there, atol=1e-13)


def test_a_tool_makes_the_last_joint_heavier_where_it_hits(arm):
    q = np.array([0.3, 0.6, 0.2, -1.4, 0.1, 0.9, 0.4])
    bare, held = arm("iiwa14"), load_robot("iiwa14", tool=HAMMER)
    felt = [hj.directional_inertia(r, q, hj.Contact(7, (0, 0, 0.15)), H) for r in (bare, held)]
    assert felt[1] > 1.2 * felt[0]


def test_every_way_to_give_one_is_the_same(tmp_path):
    (tmp_path / "hammer.toml").write_text(TOML)
    (tmp_path / "arm.urdf").write_text(load_robot("iiwa14").xml)
    (tmp_path / "arm.toml").write_text('urdf = "arm.urdf"\ntool = "hammer.toml"\n')
    (tmp_path / "inside.toml").write_text(f'name = "arm"\nurdf = "arm.urdf"\n[tool]\n{TOML}')
    ways = [
        load_robot(tmp_path / "arm.urdf", tool=tool)
        for tool in (
            HAMMER,
            Tool(**HAMMER),
            tmp_path / "hammer.toml",
            str(tmp_path / "hammer.toml"),
        )
    ]
    ways += [load_robot(tmp_path / name) for name in ("arm.toml", "inside.toml")]
    assert len({robot.digest for robot in ways}) == 1
    twin = pickle.loads(pickle.dumps(ways[0]))
    assert twin == ways[0]
    assert twin.tool.mass == 0.8
    assert load_robot(tmp_path / "arm.urdf") != ways[0]


def test_three_moments_are_a_diagonal_tensor():
    one, other = (Tool(1, [0, 0, 0], i, [0, 0, 0.1]) for i in ([1, 2, 3], np.diag([1, 2, 3])))
    np.testing.assert_array_equal(one.inertia, other.inertia)


def test_the_tip_hits_when_no_joint_is_named(arm):
    held = load_robot("iiwa14", tool=HAMMER)
    contacts = held.contacts()
    assert [c.joint for c in contacts] == sorted({*held.hitting_joints, held.n})
    assert contacts[-1] == held.flange
    assert held.contacts([7])[0] == hj.Contact(7)  # a number is always the joint's origin
    assert arm("iiwa14").contacts()[-1] != held.flange


def test_tools_on_the_command_line(tmp_path, run):
    file = tmp_path / "hammer.toml"
    file.write_text(TOML)
    line = ["--tool", file, "--q", "0.3,0.6,0.2,-1.4,0.1,0.9,0.4", "--direction", "0.6,0,0.8"]
    said = run("inspect", *line, "--offset", "tip", "--json").json
    held = load_robot("iiwa14", tool=HAMMER)
    q = [0.3, 0.6, 0.2, -1.4, 0.1, 0.9, 0.4]
    assert (said["joint"], tuple(said["offset"])) == (7, held.flange.offset)
    assert said["inertia"] == pytest.approx(hj.directional_inertia(held, q, held.flange, H))
    for words in (["--joint", "6", "--offset", "tip", *line], ["--offset", "tip"]):
        refused = run("inspect", *words)
        assert refused.code == 1
        assert "offset = tip: a tool (--tool FILE) and joint 7" in refused.err


def test_a_plan_with_the_tip_is_rolled_out_with_the_tip(tmp_path, run):
    file, planned = tmp_path / "hammer.toml", tmp_path / "plan.json"
    file.write_text(TOML)
    hit = ["--object=0.55,0.2,0.5", "--direction", "0,1,0"]
    told = run("plan", "--tool", file, *hit, "--offset", "tip", "--no-certificate",
               "--out", planned)  # fmt: skip
    assert told.code == 0
    assert "clearance not known: its tool has no radius" in told.out
    best = json.loads(planned.read_text())["best"]
    held = load_robot("iiwa14", tool=HAMMER)
    assert best["joint"] == 7
    np.testing.assert_allclose(
        hj.position(held, best["q"], held.flange), [0.55, 0.2, 0.5], atol=1e-6
    )
    heavier = tmp_path / "sledge.toml"
    heavier.write_text(TOML.replace("mass = 0.8", "mass = 1.8"))
    other = run("rollout", "--tool", heavier, "--plan", planned)
    assert other.code == 1
    assert "plan" in other.err
    rolled = run("rollout", "--tool", file, "--plan", planned, "--flux", "0.1", "--json").json
    assert np.linalg.norm(np.subtract(rolled["impact"]["position"], [0.55, 0.2, 0.5])) < 0.02


def test_a_radius_gives_the_tool_its_room():
    held = load_robot("iiwa14", tool={**HAMMER, "tip": [0, 0, 0.3], "radius": 0.02})
    bare = load_robot("iiwa14")
    q = np.array([0, 1.2, 0, -1.0, 0, 0.8, 0.0])
    lowest = hj.position(held, q, held.flange)[2]
    here, without = (hj.clearance(r, q, 6, [0, 1, 0], table_height=0.0) for r in (held, bare))
    assert here.closest["table"] == ("tool", "table")
    assert lowest - 0.02 <= here.table <= lowest
    assert here.table < without.table
    with pytest.raises(hj.ModelError, match="its tool has no radius"):
        hj.clearance(load_robot("iiwa14", tool=HAMMER), q, 6, [0, 1, 0])


WRONG = {
    "tool mass = -0.8: a mass in kg, not below zero": {"mass": -0.8},
    "tool mass = nan": {"mass": float("nan")},
    "tool mass = heavy": {"mass": "heavy"},
    "tool com = [0, 0]: 3 finite numbers": {"com": [0, 0]},
    "tool tip = [0, 0, inf]": {"tip": [0, 0, float("inf")]},
    "tool inertia = [1, 2]: 3 or 3 x 3 finite numbers": {"inertia": [1, 2]},
    "no two less than the third": {"inertia": [1e-3, 1e-3, 5e-3]},
    "none below zero": {"inertia": [-1e-3, 1e-3, 1e-3]},
    "a symmetric tensor": {"inertia": [[1, 0.5, 0], [0, 1, 0], [0, 0, 1]]},
    "zero, because the tool weighs nothing": {"mass": 0},
    "tool radius = 0: a length in m above zero": {"radius": 0},
    "tool = colour: unknown entry": {"colour": "red"},
}


@pytest.mark.parametrize("words", WRONG)
def test_tools_that_no_body_is(words, tmp_path, run):
    with pytest.raises(hj.InputError) as error:
        load_robot("iiwa14", tool={**HAMMER, **WRONG[words]})
    assert words in str(error.value)


def test_files_that_are_no_tool(tmp_path, run):
    file = tmp_path / "tool.toml"
    for text, words in (
        ("mass = [", "not a TOML file"),
        ("mass = 1", "tool = com: this entry is missing"),
        (TOML.replace("0.8", "-0.8"), "tool mass = -0.8"),
    ):
        file.write_text(text)
        told = run("inspect", "--tool", file)
        assert (told.code, told.err.count("\n")) == (1, 1)
        assert words in told.err
    told = run("inspect", "--tool", tmp_path / "none.toml")
    assert told.code == 1
    assert "tool = " in told.err
    assert "No such file" in told.err
    (tmp_path / "arm.urdf").write_text(load_robot("iiwa14").xml)
    (tmp_path / "arm.toml").write_text('urdf = "arm.urdf"\ntool = "tool.toml"\n')
    with pytest.raises(hj.ModelError, match=r"tool mass = -0\.8"):
        load_robot(tmp_path / "arm.toml")
