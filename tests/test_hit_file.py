"""hit.toml: what is written is read again, and what cannot be asked is told by file and key."""

import shutil

import numpy as np
import pytest

import hitjoints as hj
from benchmarks import hit_files
from hitjoints.errors import InputError
from hitjoints.hit_setting import HitSetting, RobotChoice

MUTATIONS = 150
"""`python -m benchmarks.hit_files` tries 2,000."""


@pytest.fixture
def written(run, tmp_path):
    """The file that `hitjoints hit --new` writes."""
    path = tmp_path / "hit.toml"
    assert run("hit", "--new", path).code == 0
    return path


def full():
    """Return a hit that says whatever can be said together."""
    return hj.Hit(
        None,
        (0.1, 1 / 3, 0.5),
        mass=0.7,
        goal=(0.4, 0.9, 0.5),
        restitution=0.4,
        friction=0.31,
        size=(0.1, 0.2, 0.3),
        yaw=-0.1,
        spread={"mass": 0.01, "speed": 0.02},
        setting=HitSetting(
            robot=RobotChoice("panda", lock={'odd "name"\n\x7f\u00e9': -0.1}),
            joints=(5, 7),
            offset=(0.0, 0.01, 0.1),
            table_height=-0.2,
            margin=0.01,
            objective="flux",
            away=False,
            torque_limits=True,
            seed=2**63 - 1,
            dt=0.001,
            q0=(0.1, 0.2, 0.3),
        ),
    )


@pytest.mark.parametrize("seed", range(20))
def test_a_direction_survives_the_file_to_the_last_bit(tmp_path, seed):
    chance = np.random.default_rng(seed)
    hit = hj.Hit(6, chance.normal(size=3), chance.normal(size=3), 2.0, 0.3)
    hit = hit.changed(setting=HitSetting(robot=RobotChoice("iiwa14")))
    hit.save(tmp_path / "hit.toml")
    again = hj.load_hit(tmp_path / "hit.toml")
    assert again == hit
    assert again.direction.tolist() == hit.direction.tolist()


def test_everything_survives_the_file(tmp_path):
    hit = full()
    hit.save(tmp_path / "hit.toml")
    again = hj.load_hit(tmp_path / "hit.toml")
    assert again == hit
    assert again.setting == hit.setting
    assert again.desired_flux == hit.desired_flux


def test_a_new_file_works_as_it_is(run, written):
    hit = hj.load_hit(written)
    assert (hit.mass, hit.flux, hit.setting.robot) == (2.0, 0.3, RobotChoice())
    written.write_text(written.read_text().replace("# joints = [5, 6, 7]", "joints = [6]"))
    outcome = run("plan", "--hit", written, "--no-certificate", "--json")
    assert outcome.code == 0
    assert outcome.json["best"]["joint"] == 6
    written.unlink()
    run("hit", "--new", written)
    again = run("hit", "--new", written)
    assert (again.code, again.err.count("\n")) == (1, 1)
    assert "is there already" in again.err


def test_every_key_of_a_new_file_is_a_key(written):
    """What is left out with a # may be put in, but for the other ways to say how hard."""
    lines = written.read_text().splitlines()
    others = (
        "# object_speed",
        "# goal",
        "# tip",
        "# base",
        "# lock",
        "# xacro",
        "# tool",
        "# A hit",
    )
    said = [line[2:] if line.startswith("# ") and " = " in line and not line.startswith(others)
            else line for line in lines]  # fmt: skip
    written.write_text("\n".join(said))
    hit = hj.load_hit(written)
    assert hit.setting.joints == (5, 6, 7)
    assert hit.setting.q0 == (0.0,) * 7
    assert hit.spread == {"mass": 0.05, "friction": 0.03}


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("mass = 2.0", 'mass = "heavy"', ["object.mass = 'heavy'", "a valid number"]),
        ("mass = 2.0", "mass = true", ["object.mass = True", "a valid number"]),
        ("mass = 2.0", "mass = nan", ["object.mass = nan", "a finite number"]),
        ("mass = 2.0", "mass = -1", ["object.mass = -1", "more than 0 kg"]),
        ("mass = 2.0", "mas = 2.0", ["object.mas = 2.0", "did you mean mass?"]),
        ("mass = 2.0", "", ["object.mass = nothing", "it is needed"]),
        ("[wish]", "[wishes]", ["wishes", "did you mean wish?"]),
        ("flux = 0.3", "flux = 0.3\nfluxx = 1", ["wish.fluxx = 1", "did you mean flux?"]),
        ("flux = 0.3", "flux = 0.3\nobject_speed = 1", ["wish.object_speed", "flux says how hard"]),
        ("[0.5, 0.3, 0.5] ", "[0.5, 0.3] ", ["object.position = [0.5, 0.3]", "at least 3 items"]),
        ("schema = 1", "schema = 2", ["schema = 2", "less than or equal to 1"]),
        ("schema = 1", "", ["schema = nothing", "it is needed"]),
        ("seed = 0", "seed = -1", ["how.seed = -1", "greater than or equal to 0"]),
        ("seed = 0", "seed = 1.5", ["how.seed = 1.5", "a valid integer"]),
        ("away = true", "away = 1", ["how.away = 1", "a valid boolean"]),
        ("schema = 1", "schema = [", ["it is no TOML file"]),
    ],
)
def test_what_is_wrong_is_told_by_file_and_key(run, written, old, new, words):
    text = written.read_text()
    assert old in text
    written.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError) as refused:
        hj.load_hit(written)
    outcome = run("plan", "--hit", written)
    assert outcome.code == 1
    assert outcome.err == f"error: {refused.value}\n"
    for word in (str(written), *words):
        assert word in outcome.err


@pytest.mark.parametrize("name", ["missing.toml", "folder"])
def test_files_that_cannot_be_read(tmp_path, name):
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="a TOML file that describes a hit is needed"):
        hj.load_hit(tmp_path / name)


def test_paths_are_relative_to_the_file(tmp_path, monkeypatch, urdf):
    arm = urdf.write(urdf.two_links(), "arm.urdf")
    inner = tmp_path / "inner"
    inner.mkdir()
    hit = hj.Hit(2, (0.3, 0.1, 0), (0, 1, 0), 1.0)
    monkeypatch.chdir(tmp_path)
    hit.changed(setting=HitSetting(robot=RobotChoice(arm.name))).save("inner/hit.toml")
    assert 'source = "../arm.urdf"' in (inner / "hit.toml").read_text()
    moved = tmp_path.parent / f"{tmp_path.name}_moved"
    shutil.move(tmp_path, moved)
    monkeypatch.chdir("/")
    found = hj.load_hit(moved / "inner" / "hit.toml").setting.robot
    assert found.load().n == 2
    assert hj.load_hit(moved / "inner" / "hit.toml").contacts(found.load())[0].joint == 2


def test_options_go_before_the_file(run, written):
    def hit(*typed):
        words = ["plan", "--no-certificate", "--flux-by", "speed", "--joint", 6, "--json"]
        return run(*words, "--hit", written, *typed).json

    found = hit()
    assert [one["joint"] for one in found["candidates"]] == [6]
    assert found["hit"]["wish"]["flux"] == 0.3
    typed = ["--robot", "panda", "--mass", "1.5", "--flux", "0.2", "--seed", 3, "--no-away"]
    found = hit(*typed)
    assert (found["robot"], found["mass"], found["flux"]) == ("panda", 1.5, 0.2)
    assert found["hit"]["how"]["seed"] == 3
    assert not found["hit"]["how"]["away"]
    found = hit("--goal", "0.5,0.5,0.5", "--restitution", "0.5", "--friction", "0.1")
    speed = np.sqrt(2 * 0.1 * 9.81 * 0.2)
    assert found["flux"] == pytest.approx(speed / 1.5)


COMMANDS = {
    "inspect": lambda said: (said["position"], said["joint"]),
    "rollout": lambda said: (said["impact"]["position"], said["joint"]),
    "simulate": lambda said: (said["impact"]["position"], said["joint"]),
    "swing": lambda said: (None, said["hit"]["contact"]["joints"][0]),
    "sweep joint": lambda said: (said["position"], said["joints"][0]["joint"]),
}


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_takes_the_file(run, written, command):
    text = written.read_text().replace("# joints = [5, 6, 7]", "joints = [6]")
    written.write_text(text.replace("[0.5, 0.3, 0.5] ", "[0.5, 0.25, 0.5] "))
    outcome = run(*command.split(), "--hit", written, "--json")
    assert outcome.code == 0, outcome.err
    position, joint = COMMANDS[command](outcome.json)
    assert joint == 6
    if position is not None:
        assert position == pytest.approx([0.5, 0.25, 0.5], abs=2e-3)


def test_mutated_files_are_never_a_traceback(written, tmp_path):
    read, wrong = hit_files.run(written.read_text(), tmp_path, MUTATIONS, seed=0)
    assert wrong == []
    assert MUTATIONS // 10 < read < MUTATIONS
