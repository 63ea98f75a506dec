"""Every result keeps its hit, and the hit makes the same result again, to the last bit."""

import contextlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.datasets.files import write_dataset
from hitjoints.errors import InputError
from hitjoints.hit_loading import hit_of
from hitjoints.hit_setting import HitSetting, RobotChoice

TOOL = """
mass = 0.4
com = [0.0, 0.0, 0.05]
inertia = [[1e-3, 0, 0], [0, 1e-3, 0], [0, 0, 1e-3]]
tip = [0.0, 0.0, 0.1]
radius = 0.03
"""


@pytest.fixture(scope="module")
def hit():
    return hj.Hit(7, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, 0.2)


@pytest.fixture(scope="module")
def swung(arm, hit):
    return hj.swing(arm("iiwa14"), hit, margin=0.004, dt=0.002, jerk=300.0)


@pytest.fixture(scope="module")
def rolled(arm, hit):
    return hj.rollout(arm("iiwa14"), hit, dt=0.004)


@pytest.mark.parametrize("ending", ["csv", "npz", "yaml", "json"])
def test_a_trajectory_makes_its_swing_again(swung, tmp_path, ending):
    path = tmp_path / f"swing.{ending}"
    swung.save(path)
    kept = hj.load_hit(path)
    assert kept == swung.hit
    if ending == "csv":
        again = hj.swing(kept)
        assert (again.joints.q == swung.joints.q).all()
        assert again.as_dict() == swung.as_dict()


@pytest.mark.parametrize("ending", ["nc", "zarr"])
def test_a_data_set_makes_its_rollout_again(rolled, tmp_path, ending):
    path = tmp_path / f"rollout.{ending}"
    write_dataset(rolled.dataset, path)
    again = hj.rollout(hj.load_hit(path))
    assert again.dataset.identical(rolled.dataset)


def test_a_simulation_is_made_again(arm, hit):
    first = hj.simulate(arm("iiwa14"), hit.changed(restitution=0.5, friction=0.3))
    again = hj.simulate(hit_of(json.loads(first.dataset.attrs["hit"]), Path("here")))
    assert again.simulated == first.simulated


def test_a_plan_with_several_offsets_is_made_again(arm, tmp_path):
    contacts = [hj.Contact(6, (0.0, 0.0, 0.03)), hj.Contact(7, (0.0, 0.01, 0.05))]
    first = hj.plan(
        arm("iiwa14"), (0.5, 0.2, 0.4), (0, 1, 0), 1.0, joints=contacts, certificate=False
    )
    first.save(tmp_path / "plan.json")
    kept = hj.load_hit(tmp_path / "plan.json")
    assert kept.contacts(arm("iiwa14")) == tuple(contacts)
    again = hj.plan(kept, certificate=False)
    assert [one.q.tolist() for one in again.candidates] == [
        one.q.tolist() for one in first.candidates
    ]
    kept.save(tmp_path / "hit.toml")
    assert hj.load_hit(tmp_path / "hit.toml") == kept


def test_the_command_keeps_several_offsets(run, tmp_path):
    path = tmp_path / "hit.toml"
    offsets = ((0.0, 0.0, 0.03), (0.0, 0.01, 0.05))
    setting = HitSetting(RobotChoice("iiwa14"), joints=(6, 7), offset=offsets)
    hj.Hit(None, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, 0.1, setting=setting).save(path)
    told = run("plan", "--hit", path, "--no-certificate", "--json").json
    assert [tuple(one["offset"]) for one in told["candidates"]] == list(offsets)


def test_an_arm_with_tool_and_tip_is_found_again_from_another_folder(tmp_path, monkeypatch):
    (tmp_path / "tool.toml").write_text(TOOL)
    (tmp_path / "deep").mkdir()
    monkeypatch.chdir(tmp_path)
    robot = hj.load_robot("iiwa14", tool="tool.toml")
    planned = hj.plan(robot, (0.5, 0.2, 0.4), (0, 1, 0), 1.0, certificate=False)
    planned.save("deep/plan.json")
    monkeypatch.chdir(tmp_path / "deep")
    kept = hj.load_plan("plan.json")
    assert kept.hit.setting.robot.tool == "../tool.toml"
    assert kept.load_robot().digest == robot.digest != hj.load_robot("iiwa14").digest


def test_limits_in_a_hit_are_those_of_its_arm(arm, hit):
    setting = HitSetting(RobotChoice("ur5"), acceleration=8.0, jerk=(90.0,) * 6)
    robot = setting.arm()
    assert robot.acceleration.tolist() == [8.0] * 6
    assert robot.jerk.tolist() == [90.0] * 6
    with pytest.raises(InputError, match="acceleration = -1"):
        replace(setting, acceleration=-1.0).arm()
    with pytest.raises(InputError, match="one for each of the 2 joints"):
        HitSetting(joints=(6, 7), offset=((0.0, 0.0, 0.0),))


@pytest.mark.parametrize("name", ["a.csv", "a.json", "a.npz", "a.nc", "a.pdf", "a.svg", "a.zarr"])
def test_what_keeps_no_hit_is_refused_in_a_line(tmp_path, name):
    path = tmp_path / name
    with pytest.raises(InputError, match=r"hit = .*: a file that hitjoints wrote is needed"):
        hj.load_hit(path)
    for content in (b"", b"{}", b'{"schema": 1, ', b"\x00\xff" * 50, b'"' + b"[" * 5000):
        path.write_bytes(content)
        with pytest.raises(InputError, match="hit = ") as refused:
            hj.load_hit(path)
        assert "\n" not in str(refused.value)


def test_numbers_of_a_path_with_odd_letters_survive(tmp_path):
    folder = tmp_path / "a (b) 'c'"
    folder.mkdir()
    hit = hj.Hit(7, np.array([0.1, 1 / 3, 2 / 3]), (0, 1, 0), 1.0, 0.2)
    hit.save(folder / "hit.toml")
    assert hj.load_hit(folder / "hit.toml").position.tolist() == hit.position.tolist()


@pytest.mark.parametrize("ending", ["png", "pdf", "svg"])
def test_a_figure_keeps_the_hit_that_it_shows(swung, tmp_path, ending):
    (tmp_path / "odd (1)").mkdir()
    path = tmp_path / "odd (1)" / f"swing.{ending}"
    hj.figures.save(hj.figures.swing(swung), path)
    assert hj.load_hit(path) == swung.hit
    once = path.read_bytes()
    assert b"hitjoints" in once
    hj.figures.save(hj.figures.swing(swung), path)
    assert path.read_bytes() == once


def test_a_figure_without_a_hit_says_so(arm, tmp_path):
    hj.figures.save(hj.figures.arm(arm("iiwa14"), np.zeros(7)), tmp_path / "arm.png")
    with pytest.raises(InputError, match="this file keeps no hit"):
        hj.load_hit(tmp_path / "arm.png")


def test_a_sweep_keeps_its_hit(arm, tmp_path):
    swept = hj.sweep_joint(arm("iiwa14"), (0.5, 0.3, 0.5), (0, 1, 0), 2.0, joints=[6, 7], count=3)
    write_dataset(swept, tmp_path / "sweep.nc")
    kept = hj.load_hit(tmp_path / "sweep.nc")
    assert (kept.setting.joints, kept.mass) == ((6, 7), 2.0)
    again = hj.sweep_joint(
        kept.setting.arm(), kept.position, kept.direction, kept.mass,
        joints=kept.setting.joints, count=3, start=kept.setting.q0, seed=kept.setting.seed,
    )  # fmt: skip
    assert again.identical(swept)


def test_a_damaged_data_set_is_refused_in_a_line(rolled, tmp_path):
    path = tmp_path / "rollout.nc"
    write_dataset(rolled.dataset, path)
    whole = path.read_bytes()
    chance, refused = np.random.default_rng(0), 0
    for _ in range(40):
        damaged = bytearray(whole)
        for place in chance.integers(0, 3000, 20):
            damaged[place] = int(chance.integers(256))
        path.write_bytes(damaged)
        with contextlib.suppress(InputError):
            hj.load_hit(path)
            continue
        refused += 1
    assert refused > 20


@pytest.mark.parametrize("command", ["rollout", "simulate", "swing"])
def test_what_a_command_says_keeps_its_hit(run, tmp_path, command):
    (tmp_path / "said.json").write_text(run(command, "--joint", 7, "--flux", 0.2, "--json").out)
    kept = hj.load_hit(tmp_path / "said.json")
    assert (kept.flux, kept.chosen_contact.joint) == (0.2, 7)
    assert kept.setting.robot.source == "iiwa14"
