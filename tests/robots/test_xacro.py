"""Xacro files: expanded, their arguments checked, packages found without ROS."""

import importlib.util

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import MissingExtraError
from hitjoints.loading import xacro_file
from hitjoints.loading.load import load_robot

HEAD = '<robot name="twin" xmlns:xacro="http://www.ros.org/wiki/xacro">'
MACROS = f"""{HEAD}
<xacro:macro name="limb" params="i parent length mass">
  <link name="limb_${{i}}"><inertial><origin xyz="0 0 ${{length / 2}}"/><mass value="${{mass}}"/>
    <inertia ixx="${{mass * length**2 / 12}}" iyy="${{mass * length**2 / 12}}" izz="0.001"
      ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="turn_${{i}}" type="revolute"><parent link="${{parent}}"/><child link="limb_${{i}}"/>
    <origin xyz="0 0 ${{0 if i == 1 else length}}"/><axis xyz="${{'0 0 1' if i % 2 else '0 1 0'}}"/>
    <limit lower="-2" upper="2" velocity="3" effort="40"/></joint>
</xacro:macro></robot>"""
MAIN = f"""{HEAD}
<xacro:include filename="$(find parts)/urdf/macros.xacro"/>
<xacro:arg name="length" default="0.3"/><xacro:arg name="heavy" default="false"/>
<xacro:property name="mass" value="${{2.0 if '$(arg heavy)' == 'true' else 1.0}}"/>
<link name="base"/>
<xacro:limb i="1" parent="base" length="$(arg length)" mass="${{mass}}"/>
<xacro:limb i="2" parent="limb_1" length="$(arg length)" mass="${{mass}}"/>
<xacro:limb i="3" parent="limb_2" length="$(arg length)" mass="${{mass}}"/>
</robot>"""


def by_hand(length, mass):
    tensor = mass * length**2 / 12
    text = '<robot name="twin"><link name="base"/>'
    for i in (1, 2, 3):
        text += (
            f'<link name="limb_{i}"><inertial><origin xyz="0 0 {length / 2}"/>'
            f'<mass value="{mass}"/>'
            f'<inertia ixx="{tensor}" iyy="{tensor}" izz="0.001" ixy="0" ixz="0" iyz="0"/>'
            f'</inertial></link><joint name="turn_{i}" type="revolute">'
            f'<parent link="{"base" if i == 1 else f"limb_{i - 1}"}"/><child link="limb_{i}"/>'
            f'<origin xyz="0 0 {0 if i == 1 else length}"/>'
            f'<axis xyz="{"0 0 1" if i % 2 else "0 1 0"}"/>'
            '<limit lower="-2" upper="2" velocity="3" effort="40"/></joint>'
        )
    return text + "</robot>"


@pytest.fixture
def arm_file(tmp_path):
    macros = tmp_path / "parts" / "urdf" / "macros.xacro"
    macros.parent.mkdir(parents=True)
    macros.write_text(MACROS)
    path = tmp_path / "arm" / "arm.urdf.xacro"
    path.parent.mkdir()
    path.write_text(MAIN)
    return path


def felt(robot):
    q = np.array([0.3, 0.7, -0.4])
    return hj.directional_inertia(robot, q, hj.Contact(3, (0, 0.1, 0.2)), [0, 1, 0])


@pytest.mark.parametrize(
    ("arguments", "numbers"),
    [({}, (0.3, 1.0)), ({"length": "0.4"}, (0.4, 1.0)), ({"heavy": "true"}, (0.3, 2.0))],
)
def test_it_is_the_arm_written_out_by_hand(arm_file, arguments, numbers):
    robot = load_robot(arm_file, xacro_args=arguments)
    assert robot.name == "arm"
    assert felt(robot) == pytest.approx(felt(load_robot(by_hand(*numbers))), rel=1e-12)


def test_packages_are_found_where_they_are_told(arm_file, tmp_path, run):
    elsewhere = tmp_path / "far" / "away"
    elsewhere.mkdir(parents=True)
    (tmp_path / "parts").rename(elsewhere / "parts")
    line = ["inspect", "--robot", arm_file, "--q", "0.3,0.7,-0.4", "--joint", "3"]
    told = run(*line)
    assert told.code == 1
    assert "package parts not found: name its folder with --package-dir" in told.err
    assert run(*line, "--package-dir", elsewhere).code == 0
    facts = arm_file.parent / "arm.toml"
    facts.write_text('urdf = "arm.urdf.xacro"\npackage_dirs = ["../far/away"]\n'
                     '[xacro_args]\nlength = "0.4"\n')  # fmt: skip
    assert felt(load_robot(facts)) == pytest.approx(felt(load_robot(by_hand(0.4, 1.0))))


def test_arguments_on_the_command_line(arm_file, run):
    line = ["inspect", "--robot", arm_file, "--q", "0.3,0.7,-0.4", "--joint", "3", "--json"]
    light, heavy = (run(*line, "--xacro-arg", f"heavy:={word}").json for word in ("false", "true"))
    assert heavy["inertia"] == pytest.approx(2 * light["inertia"], rel=0.01)
    wrong = run(*line, "--xacro-arg", "weight:=3")
    assert wrong.code == 1
    assert "xacro-arg = weight:=3: its arguments are heavy, length" in wrong.err
    for words in ("heavy=true", ":=1", "heavy"):
        assert run(*line, "--xacro-arg", words).code == 2
    plain = run("inspect", "--xacro-arg", "heavy:=true")
    assert plain.code == 1
    assert "xacro-arg = heavy: iiwa14 is no xacro file" in plain.err


BROKEN = {
    "macro": ('<xacro:limb i="1"/>', "limb"),
    "argument": ('<link name="$(arg side)_base"/>', "side"),
    "property": ('<link name="${side}"/>', "side"),
    "division": ('<link name="${1/0}"/>', "division by zero"),
    "include": ('<xacro:include filename="no.xacro"/>', "no.xacro"),
    "environment": ('<link name="$(env NO_SUCH_VARIABLE_HERE)"/>', "NO_SUCH_VARIABLE_HERE"),
    "not well-formed": ("<link>", "mismatched tag"),
    "exit": ("<xacro:property name='a' value='${[].append.__self__.__class__}'/>${a}", ""),
}


@pytest.mark.parametrize("fault", BROKEN)
def test_what_xacro_cannot_expand_is_told_in_a_line(tmp_path, run, fault):
    body, word = BROKEN[fault]
    path = tmp_path / "arm.xacro"
    path.write_text(f'{HEAD}{body}<link name="base"/></robot>')
    told = run("inspect", "--robot", path)
    assert told.code == 1
    assert told.err.count("\n") == 1
    assert word in told.err


def test_a_file_that_loops_is_given_up(tmp_path, monkeypatch):
    monkeypatch.setattr(xacro_file, "LONGEST", 1.0)
    path = tmp_path / "arm.xacro"
    loops = '<xacro:macro name="a"><xacro:a/><xacro:a/></xacro:macro><xacro:a/>'
    path.write_text(f"{HEAD}{loops}</robot>")
    with pytest.raises(hj.ModelError, match="xacro"):
        load_robot(path)


def test_nothing_in_the_working_folder_is_imported(arm_file, tmp_path, monkeypatch):
    for name in ("xacro", "yaml", "json", "hitjoints"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('imported')")
    monkeypatch.chdir(tmp_path)
    assert load_robot(arm_file).n == 3


def test_without_the_package_the_install_line_is_told(arm_file, monkeypatch):
    monkeypatch.setattr(xacro_file, "find_spec", lambda name: None)
    assert importlib.util.find_spec("xacro")
    with pytest.raises(MissingExtraError, match=r"pip install 'hitjoints\[xacro\]'"):
        load_robot(arm_file)
