"""Which arm: the options of every command that takes a robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from .complaints import complain
from .completion import robots
from .option_groups import OptionGroup

if TYPE_CHECKING:
    from hitjoints.hit_setting import RobotChoice
    from hitjoints.model.robot import Robot

ROBOT = "iiwa14"


@dataclass(frozen=True)
class RobotOptions(OptionGroup):
    """The arm."""

    panel: ClassVar[str] = "The arm"

    robot: Annotated[
        str,
        typer.Option(
            "--robot",
            metavar="NAME|FILE",
            help="Name, or URDF, xacro, MJCF or TOML.",
            autocompletion=robots,
        ),
    ] = ROBOT
    tip: Annotated[
        str | None,
        typer.Option("--tip", metavar="LINK", help="Link the arm ends with, if there are several."),
    ] = None
    base: Annotated[
        str | None,
        typer.Option("--base", metavar="LINK", help="Link the arm stands on. (default: the root)"),
    ] = None
    lock: Annotated[
        list[str] | None,
        typer.Option(
            "--lock", metavar="NAME[=VALUE]", help="Joint to hold, at 0 or there; may be repeated."
        ),
    ] = None
    tool: Annotated[
        Path | None,
        typer.Option(
            "--tool", metavar="FILE", help="Tool on the flange: TOML of mass, com, inertia, tip."
        ),
    ] = None
    package_dirs: Annotated[
        list[Path] | None,
        typer.Option(
            "--package-dir", metavar="DIR", help="Folder of package:// addresses; may be repeated."
        ),
    ] = None
    xacro_args: Annotated[
        list[str] | None,
        typer.Option(
            "--xacro-arg", metavar="NAME:=VALUE", help="Argument of a xacro file; may be repeated."
        ),
    ] = None

    @property
    def chosen(self) -> dict[str, Any]:
        """The arguments of `load_robot` beside the source."""
        return {
            "tip": self.tip,
            "base": self.base,
            "lock": self.lock,
            "tool": self.tool,
            "package_dirs": self.package_dirs or (),
            "xacro_args": assigned(self.xacro_args or ()),
        }

    @property
    def choice(self) -> RobotChoice:
        """The arm as a hit keeps it."""
        from hitjoints.hit_setting import RobotChoice
        from hitjoints.loading.facts import read_lock

        given = self.chosen
        dirs = tuple(str(folder) for folder in given.pop("package_dirs"))
        lock = read_lock(given.pop("lock"))
        return RobotChoice(self.robot, lock=lock, package_dirs=dirs, **given)

    def load(self) -> Robot:
        """Load it.

        Raises:
            InputError, ModelError: as `load_robot`.
        """
        from hitjoints.loading.load import load_robot

        arm = load_robot(self.robot, **self.chosen)
        complain("detail", f"{arm.title}: {arm.n} joints, digest {arm.digest[:12]}; {arm.source}")
        return arm


def assigned(words: Sequence[str]) -> dict[str, str]:
    """Read "NAME:=VALUE", each once."""
    pairs = [word.partition(":=") for word in words]
    for word, (name, sign, _) in zip(words, pairs, strict=True):
        if not (name and sign):
            raise typer.BadParameter(f"{word!r} is not of the form NAME:=VALUE")
    return {name: value for name, _, value in pairs}
