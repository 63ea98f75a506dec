"""Files and arguments that no sane person writes end in one clear line."""

import contextlib
import os
import threading

import numpy as np
import pytest

from hitjoints.errors import HitjointsError, InputError, ModelError
from hitjoints.loading.load import load_robot


def refusal(source, **options):
    with pytest.raises(HitjointsError) as caught:
        load_robot(source, **options)
    text = str(caught.value)
    assert "\n" not in text
    assert len(text) < 1000
    return text


@pytest.mark.parametrize("depth", [2_000, 100_000])
def test_deep_nesting(urdf, depth):
    text = urdf.two_links().replace("</robot>", "<a>" * depth + "</a>" * depth + "</robot>")
    path = urdf.write(text)
    with contextlib.suppress(ModelError):
        load_robot(path)
    toml = urdf.write(f"home = {'[' * depth}{']' * depth}", "deep.toml")
    assert "nested too deeply" in refusal(toml)


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/null"])
def test_devices(name, tmp_path):
    toml = tmp_path / "arm.toml"
    toml.write_text(f'urdf = "{name}"')
    (tmp_path / "arm.urdf").symlink_to(name)
    for source in (toml, tmp_path / "arm.urdf"):
        assert "a file, not a device or a pipe" in refusal(source)


def test_a_pipe_without_end(tmp_path):
    os.mkfifo(tmp_path / "arm.urdf")
    said = []
    asked = threading.Thread(target=lambda: said.append(refusal(tmp_path / "arm.urdf")))
    asked.daemon = True
    asked.start()
    asked.join(5)
    assert said
    assert "a pipe" in said[0]


def test_links_in_a_loop(tmp_path):
    for name in ("arm.urdf", "arm.toml"):
        (tmp_path / name).symlink_to(tmp_path / name)
        assert "symbolic links" in refusal(tmp_path / name)


@pytest.mark.parametrize("name", ["x" * 300, "x" * 300 + ".urdf", "x" * 300 + ".toml", "a\0b"])
def test_names_that_no_file_has(name):
    assert "robot = " in refusal(name)


@pytest.mark.parametrize("name", ["a\\u0000b", "x" * 5000])
def test_names_in_a_toml_that_no_file_has(name, tmp_path):
    toml = tmp_path / "arm.toml"
    toml.write_text(f'urdf = "{name}.urdf"')
    assert "robot = " in refusal(toml)


HUGE = ["1" + "0" * 400, "1" + "0" * 5000, "0x" + "f" * 5000]


@pytest.mark.parametrize("number", HUGE, ids=["400 digits", "5000 digits", "hexadecimal"])
@pytest.mark.parametrize("line", ["home = [{}, 0]", "armature = [{}, 0]", "hitting_joints = [{}]",
                                  "lock = [{}]", "name = {}", "jerk = [{}]"])  # fmt: skip
def test_huge_whole_numbers(urdf, line, number):
    urdf.write(urdf.two_links())
    text = refusal(urdf.write('urdf = "small.urdf"\n' + line.format(number), "arm.toml"))
    assert line.split()[0] in text or "not a TOML file" in text


WRONG = ["true", '"text"', "1979-05-27", "{ a = 1 }", '["a"]', "[[1], 2]", "[{}]", "nan", "[true]"]


@pytest.mark.parametrize("value", WRONG)
@pytest.mark.parametrize("key", ["urdf", "home", "hitting_joints", "flange", "armature", "jerk"])
def test_wrong_types(urdf, key, value):
    urdf.write(urdf.two_links())
    lines = {"urdf": '"small.urdf"', key: value}
    text = "\n".join(f"{k} = {v}" for k, v in lines.items())
    said = refusal(urdf.write(text, "arm.toml"))
    assert key in said or "text" in said


def test_as_many_joints_as_an_arm_has(urdf):
    def chain(n):
        links = [urdf.link(f"link_{k}") for k in range(1, n + 1)]
        ends = ["base", *(f"link_{k}" for k in range(1, n + 1))]
        joints = [urdf.joint(f"joint_{k}", ends[k - 1], ends[k]) for k in range(1, n + 1)]
        return urdf.base, *links, *joints

    assert urdf.load(*chain(16)).n == 16
    for n in (17, 600):
        with pytest.raises(ModelError, match=f"it has {n} joints, an arm at most 16"):
            urdf.load(*chain(n))


def test_markup_in_names_is_text(urdf, run):
    name = "[/red]:tada:[bold]"
    joints = urdf.joint("j1", "base", "link_1"), urdf.joint("j2", "link_1", name)
    parts = urdf.base, urdf.link("link_1"), urdf.link(name, moments=(0, 0, 0)), *joints
    told = run("robots", "check", urdf.write(urdf.robot(*parts)))
    assert told.code == 0
    assert name in told.words


@pytest.mark.parametrize("value", [None, 3, 2.5, b"iiwa14", ["iiwa14"], "", np.zeros(3)])
def test_sources_that_are_none(value):
    with pytest.raises((InputError, TypeError)):
        load_robot(value)
