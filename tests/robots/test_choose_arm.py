"""One arm of a description: tip, base, lock, and what is meant when nothing is said."""

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InputError, ModelError, UnknownNameError
from hitjoints.loading.load import load_robot, read_arm
from hitjoints.loading.source import describe
from hitjoints.model.robot import Contact

H = np.array([0.3, 0.8, 0.5]) / np.linalg.norm([0.3, 0.8, 0.5])
SLIDE = '<limit lower="0" upper="0.04" velocity="0.2" effort="20"/>'


def arm_of(urdf, *more, joints=4, name="j"):
    """Return a serial arm on the base, links `seg1`.. and joints `j1`.., followed by more."""
    parts = [urdf.base]
    for k in range(1, joints + 1):
        above = "base" if k == 1 else f"seg{k - 1}"
        axis = "0 0 1" if k % 2 else "0.1 1 0"
        parts.append(urdf.link(f"seg{k}", mass=1 + k / 10))
        parts.append(urdf.joint(f"{name}{k}", above, f"seg{k}", at="0.1 0 0.2", axis=axis))
    return urdf.robot(*parts, *more)


def finger(urdf, side, more=SLIDE, on="seg4", kind="prismatic"):
    return (
        urdf.link(f"finger_{side}", mass=0.05),
        urdf.joint(f"grip_{side}", on, f"finger_{side}", kind, at="0 0 0.08", more=more),
    )


def flange(urdf, name="flange", on="seg4"):
    return urdf.link(name, mass=0.1), urdf.joint(f"to_{name}", on, name, "fixed", at="0 0 0.1")


def held_of(path, **options):
    return read_arm(describe(path), **options).held


MIMIC = SLIDE + '<mimic joint="grip_l" multiplier="-0.5" offset="0.01"/>'


def test_fingers_and_what_mimics_them_are_held(urdf):
    xml = arm_of(urdf, *finger(urdf, "l"), *finger(urdf, "r", MIMIC))
    path = urdf.write(xml)
    robot = load_robot(path)
    assert robot.joint_names == ["j1", "j2", "j3", "j4"]
    assert robot.model.inertias[4].mass == pytest.approx(1.4 + 0.1)
    assert held_of(path) == {"grip_l": 0, "grip_r": 0.01}
    assert held_of(path, lock={"grip_l": 0.03}) == {"grip_l": 0.03, "grip_r": pytest.approx(-0.005)}
    assert held_of(path, lock="grip_l=0.03")["grip_l"] == 0.03


@pytest.mark.parametrize("name", ["gripper_jaw", "finger", "left_claw", "Jaw"])
def test_a_jaw_at_the_end_is_no_hitting_joint(urdf, name):
    xml = arm_of(urdf, urdf.link("last"), urdf.joint(name, "seg4", "last"))
    assert load_robot(urdf.write(xml)).n == 4


@pytest.mark.parametrize("end", ["flange", "tool0", "lbr_flange", "arm-tool0", "a_ee_link", "TCP"])
def test_a_joint_beyond_a_flange_is_a_jaw_whatever_it_is_called(urdf, end):
    on = urdf.joint("clamp", end, "last")
    robot = load_robot(urdf.write(arm_of(urdf, *flange(urdf, end), urdf.link("last"), on)))
    assert robot.n == 4
    assert robot.flange == Contact(4, (0, 0, 0.1))


def test_a_link8_in_the_middle_of_an_arm_is_no_end(urdf):
    xml = arm_of(urdf, joints=7).replace("seg3", "arm_link8")
    assert load_robot(urdf.write(xml)).n == 7
    head = urdf.link("head"), urdf.joint("nod", "base", "head")
    with pytest.raises(ModelError, match=r"--tip seg7 \(7 joints\), --tip head \(1 joint\)"):
        load_robot(urdf.write(xml.replace("</robot>", "".join(head) + "</robot>")))


def test_a_hand_beyond_a_flange_is_held(urdf):
    hand = [flange(urdf)]
    for side in "abc":
        hand.append((urdf.link(f"{side}1"), urdf.joint(f"{side}1", "flange", f"{side}1")))
        hand.append((urdf.link(f"{side}2"), urdf.joint(f"{side}2", f"{side}1", f"{side}2")))
    xml = arm_of(urdf, *(part for pair in hand for part in pair))
    robot = load_robot(urdf.write(xml))
    assert robot.n == 4
    assert robot.flange == Contact(4, (0, 0, 0.1))


def two_arms(urdf):
    parts = [urdf.base, urdf.link("torso"), urdf.joint("lift", "base", "torso", "prismatic")]
    for side in ("left", "right"):
        for k in (1, 2, 3):
            above = "torso" if k == 1 else f"{side}_{k - 1}"
            axis = ("0 0 1", "0 1 0", "1 0 0")[k - 1]
            parts.append(urdf.link(f"{side}_{k}", mass=1 + k / 10))
            parts.append(urdf.joint(f"{side}_j{k}", above, f"{side}_{k}", axis=axis, rpy="0 0 .4"))
        parts += flange(urdf, f"{side}_tool0", f"{side}_3")
    parts += [urdf.link("head"), urdf.joint("nod", "torso", "head")]
    return urdf.robot(*parts)


def test_several_arms_are_listed_with_the_option_to_add(urdf):
    with pytest.raises(ModelError) as caught:
        load_robot(urdf.write(two_arms(urdf)))
    assert str(caught.value).endswith(
        "it ends in 3 places: choose one with --tip left_tool0 (4 joints), "
        '--tip right_tool0 (4 joints), --tip head (2 joints) (in Python tip="left_tool0")'
    )


@pytest.mark.parametrize("tip", ["left_tool0", "left_3", "left_j3"])
def test_tip(urdf, tip):
    path = urdf.write(two_arms(urdf))
    robot = load_robot(path, tip=tip)
    assert robot.joint_names == ["lift", "left_j1", "left_j2", "left_j3"]
    assert robot.flange == Contact(4, (0, 0, 0.1))
    assert held_of(path, tip=tip) == dict.fromkeys(["right_j1", "right_j2", "right_j3", "nod"], 0)
    # What hangs off the way rides along: the other arm weighs on the lift.
    assert robot.model.inertias[1].mass == pytest.approx(1 + 1.1 + 1.2 + 1.3 + 0.1 + 1)


def test_base_is_where_the_arm_stands(urdf):
    path = urdf.write(two_arms(urdf))
    whole, part = (load_robot(path, tip="left_tool0", base=base) for base in (None, "torso"))
    assert part.joint_names == ["left_j1", "left_j2", "left_j3"]
    q = np.array([0.2, -0.5, 0.7])
    lifted = np.array([0.25, *q])
    shift = position(whole, lifted, Contact(2)) - position(part, q, Contact(1))
    found = position(whole, lifted, whole.flange) - position(part, q, part.flange)
    np.testing.assert_allclose(found, shift, atol=1e-14)
    with pytest.raises(ModelError, match="the tip head does not hang on the base left_1"):
        load_robot(path, tip="head", base="left_1")
    # The arm alone is found without a tip once the base leaves nothing else.
    assert load_robot(path, base="right_1").joint_names == ["right_j2", "right_j3"]


VALUES = [("j2", "revolute", 0.7), ("j2", "revolute", -1.0), ("j2", "prismatic", 0.3),
          ("j4", "continuous", 2.9), ("j1", "revolute", np.pi / 2)]  # fmt: skip


@pytest.mark.parametrize(("name", "kind", "value"), VALUES)
def test_a_joint_held_at_a_value_is_the_joint_there(urdf, name, kind, value):
    """Positions, and the inertia at the tip, against the free arm whose joint cannot be moved."""
    turned = urdf.joint(name, "A", "B", kind, at="0.1 0.2 0.3", rpy="0.4 1.2 -2", axis="1 -2 0.5",
                        more='<limit lower="-3" upper="3" velocity="2" effort="3"/>')  # fmt: skip
    number = int(name[1])
    above = "base" if number == 1 else f"seg{number - 1}"
    xml = arm_of(urdf)
    start = xml.index(f'<joint name="{name}"')
    stop = xml.index("</joint>", start) + len("</joint>")
    placed = turned.replace('"A"', f'"{above}"').replace('"B"', f'"seg{number}"')
    path = urdf.write(xml[:start] + placed + xml[stop:])
    free, held = load_robot(path), load_robot(path, lock={name: value})
    rng = np.random.default_rng(1)
    for q in rng.uniform(-1, 1, (20, 4)):
        q[number - 1] = value
        rest = np.delete(q, number - 1)
        tip = Contact(4, (0.1, 0.2, 0.3))
        at = position(free, q, tip)
        last = held.n
        frame = held.model.frames[held.model.getFrameId("seg4", pin.FrameType.BODY)]
        point = frame.placement.act(np.array(tip.offset))
        found = position(held, rest, Contact(last, tuple(point)))
        np.testing.assert_allclose(found, at, atol=1e-13)
        matrix = pin.crba(free.model, free.model.createData(), q)
        kept = np.delete(np.delete(matrix, number - 1, 0), number - 1, 1)
        found = pin.crba(held.model, held.model.createData(), rest)
        np.testing.assert_allclose(found, kept, rtol=1e-12, atol=1e-13)


def test_a_joint_that_cannot_be_at_zero_is_held_at_its_nearest_limit(urdf):
    wide = '<limit lower="0.2" upper="0.8" velocity="1" effort="1"/>'
    path = urdf.write(arm_of(urdf, *finger(urdf, "l", wide)))
    assert held_of(path) == {"grip_l": 0.2}


def test_a_mimicking_joint_on_the_way_is_refused_without_the_advice_to_lock_it(urdf):
    xml = arm_of(urdf)
    start = xml.index("</joint>", xml.index('name="j3"'))
    path = urdf.write(xml[:start] + '<mimic joint="j1"/>' + xml[start:])
    with pytest.raises(ModelError) as caught:
        load_robot(path)
    assert "joint j3 on the way to the tip seg4 follows j1: choose a tip before it" in str(
        caught.value
    )
    assert load_robot(path, tip="seg2").n == 2


def test_a_floating_base_off_the_way_is_held(urdf):
    free = urdf.joint("free", "world", "base", "floating")
    xml = arm_of(urdf, '<link name="world"/>', free)
    with pytest.raises(ModelError, match="joint free: its base floats"):
        load_robot(urdf.write(xml))
    assert load_robot(urdf.write(xml), base="base").n == 4
    assert load_robot(urdf.write(xml), lock="free").n == 4


def test_unknown_names_list_the_choices(urdf):
    path = urdf.write(two_arms(urdf))
    with pytest.raises(UnknownNameError) as caught:
        load_robot(path, tip="left_tool")
    meant = "did you mean left_tool0? Else choose one of head, left_tool0, right_tool0"
    assert str(caught.value) == f"tip = 'left_tool': {meant}"
    with pytest.raises(UnknownNameError, match="base = 'trunk': choose one of base, head, left_1"):
        load_robot(path, base="trunk")
    with pytest.raises(UnknownNameError, match="lock = 'knee': choose one of left_j1"):
        load_robot(path, tip="head", lock="knee")


LOCKS = {
    "outside": ({"nod": 1.5}, "lock = nod=1.5: joint nod moves from -1 to 1"),
    "text": ("nod=high", "lock = nod=high: NAME or NAME=VALUE"),
    "nothing": ("nod=", "lock = nod=: NAME or NAME=VALUE"),
    "nan": ({"nod": np.nan}, "lock = nod=nan: NAME or NAME=VALUE"),
    "infinite": ("nod=inf", "lock = nod=inf: NAME or NAME=VALUE"),
    "flag": ({"nod": True}, "lock = nod: NAME or NAME=VALUE"),
    "number": ([3], "lock = 3: NAME or NAME=VALUE"),
}


@pytest.mark.parametrize("case", LOCKS)
def test_refused_locks(urdf, case):
    lock, message = LOCKS[case]
    with pytest.raises(InputError) as caught:
        load_robot(urdf.write(two_arms(urdf)), tip="left_tool0", lock=lock)
    assert message in str(caught.value)


def test_every_form_of_lock_is_the_same(urdf):
    path = urdf.write(two_arms(urdf))
    expected = load_robot(path, tip="left_tool0", lock={"nod": 0.5, "lift": 0.0})
    forms = (["nod=0.5", "lift"], ("lift", "nod=5e-1"), {"lift": 0, "nod": np.float64(0.5)})
    for lock in forms:
        assert load_robot(path, tip="left_tool0", lock=lock) == expected
    for line in ('["nod=0.5", "lift"]', "{ nod = 0.5, lift = 0 }"):
        text = f'name = "small"\nurdf = "small.urdf"\ntip = "left_tool0"\nlock = {line}'
        toml = urdf.write(text, "arm.toml")
        assert load_robot(toml) == expected
        both = load_robot(toml, lock="left_j2=0.25")
        assert both.joint_names == ["left_j1", "left_j3"]


def test_a_toml_says_tip_and_base_and_the_caller_has_the_last_word(urdf):
    urdf.write(two_arms(urdf))
    text = 'urdf = "small.urdf"\ntip = "left_tool0"\nbase = "torso"'
    toml = urdf.write(text, "arm.toml")
    assert load_robot(toml).joint_names == ["left_j1", "left_j2", "left_j3"]
    assert load_robot(toml, tip="head").joint_names == ["nod"]
    assert load_robot(toml, base="base").n == 4


def test_the_flange_is_the_tip_when_no_usual_name_is_there(urdf):
    xml = arm_of(urdf, *flange(urdf, "knuckle_plate"))
    assert load_robot(urdf.write(xml)).flange == Contact(4)
    assert load_robot(urdf.write(xml), tip="knuckle_plate").flange == Contact(4, (0, 0, 0.1))
    both = arm_of(urdf, *flange(urdf, "x_tcp"), *flange(urdf, "x_flange"))
    assert load_robot(urdf.write(both.replace("0 0 0.1", "0 0 0.7", 1))).flange.joint == 4


def test_tolerance_of_what_urdfdom_reads(urdf):
    plain = load_robot(urdf.write(arm_of(urdf, *flange(urdf)), "plain.urdf"))
    text = arm_of(urdf, *flange(urdf), urdf.joint("mount", "world", "base", "fixed", at="0 0 0.4"))
    odd = '<gazebo:plugin name="x" sensor:y="1"/>'
    for variant in (
        text,
        "\n\n  " + text,
        '\n<?xml version="1.0"?>\n' + text,
        text.replace('<robot name="small">', "<robot>" + odd),
        "\ufeff" + text,
    ):
        robot = load_robot(urdf.write(variant))
        assert robot.joint_names == plain.joint_names
        q = np.array([0.1, 0.4, -0.3, 0.2])
        shifted = position(plain, q, 4) + np.array([0, 0, 0.4])
        np.testing.assert_allclose(position(robot, q, 4), shifted, atol=1e-15)
        h = np.array([0.0, 1.0, 0.0])
        expected = inertia_along(plain, q, Contact(4), h)
        assert inertia_along(robot, q, Contact(4), h) == pytest.approx(expected, rel=1e-13)
        given = load_robot(variant)
        assert given.name == "robot"
        assert given.joint_names == plain.joint_names


def test_unexpanded_xacro_is_refused(urdf):
    rod = '<xacro:rod m="0.8"/>'
    xml = arm_of(urdf).replace("</link>", rod + "</link>", 1)
    with pytest.raises(ModelError, match="it holds <xacro:rod>, which is xacro and not URDF"):
        load_robot(urdf.write(xml))


def test_a_robot_survives_as_text(urdf):
    robot = load_robot(urdf.write(arm_of(urdf, *flange(urdf))))
    again = load_robot(robot.xml)
    np.testing.assert_array_equal(again.upper, robot.upper)
    assert again.flange == robot.flange


def test_near_names_are_offered():
    with pytest.raises(UnknownNameError, match="did you mean "):
        load_robot("ur5e_robot")
    with pytest.raises(UnknownNameError, match="did you mean iiwa14"):
        load_robot("iiwa15")
