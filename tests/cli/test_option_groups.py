"""A command takes groups of options; to write one takes two files."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

import pytest
import typer

from hitjoints.cli.app import app
from hitjoints.cli.hit_options import HitOptions
from hitjoints.cli.option_groups import OptionGroup, grouped, without
from hitjoints.cli.options import JsonOption
from hitjoints.cli.render import print_json
from hitjoints.cli.robot_options import RobotOptions
from hitjoints.errors import InputError


@dataclass(frozen=True)
class Colours(OptionGroup):
    panel: ClassVar[str] = "The paint"

    colour: Annotated[str, typer.Option("--colour")] = "red"
    joint: Annotated[int, typer.Option("--joint")] = 1


def paint(
    robot: RobotOptions,
    hit: Annotated[HitOptions, without("flux", "joint")],
    colours: Colours,
    as_json: JsonOption = False,
) -> None:
    """Paint a link."""
    asked = hit.read()
    assert as_json
    print_json(
        {
            "joints": robot.load().n,
            "mass": asked.mass,
            "at": asked.position,
            "paint": [colours.colour, colours.joint],
        }
    )


@pytest.fixture
def painting():
    """The command in the application, as its file and a line there put it."""
    app.command("paint")(grouped(paint))
    yield
    app.registered_commands.pop()


@pytest.mark.usefixtures("painting")
def test_a_command_of_groups(run):
    words = ["paint", "--robot", "xarm7", "--object", "1,2,3", "--colour", "blue", "--joint", "4"]
    assert run(*words, "--json").json == {
        "joints": 7,
        "mass": 2.0,
        "at": [1, 2, 3],
        "paint": ["blue", 4],
    }
    outcome = run("paint", "-h")
    assert outcome.code == 0
    for word in ("The arm", "The hit", "The paint", "--offset", "Paint a link."):
        assert word in outcome.words
    assert "--flux" not in outcome.words
    assert run("paint", "--flux", "1").code == 2


def test_two_options_of_one_name_are_refused():
    def twice(hit: HitOptions, colours: Colours) -> None:
        """Take --joint twice."""

    with pytest.raises(TypeError, match="two options of one name"):
        grouped(twice)


def test_what_one_command_takes_once(run, arm):
    assert run("inspect", "--joint", 5, "--joint", 6).err == (
        "error: joint = 5, 6: this command takes one\n"
    )
    assert "direction = " in run("plan", "--direction", "0,1,0", "--direction", "1,0,0").err
    asked = HitOptions(joint=[3], offset="0,0.1,0").read()
    assert asked.contact(arm("iiwa14")).offset == (0, 0.1, 0)
    with pytest.raises(InputError, match="joint = 8"):
        HitOptions(joint=[8]).read().contact(arm("iiwa14"))


def test_a_value_that_contradicts_the_plan(arm):
    import hitjoints as hj

    plan = hj.plan(arm("iiwa14"), [0.5, 0.3, 0.5], [0, 1, 0], 2.0, [6], certificate=False)
    with pytest.raises(InputError, match=r"object = .*the plan is for 0.5,0.3,0.5"):
        HitOptions(position="0.5,0.3,0.6").read(plan)
    with pytest.raises(InputError, match=r"direction = .*the plan is for 0,1,0"):
        HitOptions(direction=["0,1,0.1"]).read(plan)
    with pytest.raises(InputError, match=r"mass = 2.5: the plan is for 2"):
        HitOptions(mass=2.5).read(plan)
    assert HitOptions(position="0.5,0.3,0.5", direction=["0,3,0"], mass=2.0).read(plan)


@pytest.mark.parametrize("words", [["plan", "--no-certificate"], ["sweep", "joint", "--count", 5]])
def test_the_offset_is_one_option_everywhere(run, arm, words):
    import hitjoints as hj

    offset = (0.0, 0.05, 0.1)
    found = run(*words, "--joint", 6, "--offset", "0,0.05,0.1", "--json").json
    q = found["best"]["q"] if "best" in found else found["joints"][0]["q"]
    here = hj.position(arm("iiwa14"), q, hj.Contact(6, offset))
    assert here == pytest.approx([0.5, 0.3, 0.5], abs=1e-6)
    origin = hj.position(arm("iiwa14"), q, 6)
    assert abs(origin - [0.5, 0.3, 0.5]).max() > 0.05


def test_versions(run):
    said = run("--version").out
    for name in ("hitjoints ", "pin ", "proxsuite ", "numpy "):
        assert name in said
