"""Which arm: the options of every command that takes a robot."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from .option_groups import OptionGroup

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot

ROBOT = "iiwa14"


@dataclass(frozen=True)
class RobotOptions(OptionGroup):
    """The arm."""

    panel: ClassVar[str] = "The arm"

    robot: Annotated[
        str,
        typer.Option("--robot", metavar="NAME|FILE", help="Built-in name, or a URDF or TOML file."),
    ] = ROBOT

    def load(self) -> Robot:
        """Load it.

        Raises:
            InputError, ModelError: as `load_robot`.
        """
        from hitjoints.loading.load import load_robot

        return load_robot(self.robot)
