"""What belongs to a hit beside the object and the wish: the arm, the surroundings, and how."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from hitjoints.errors import InputError
from hitjoints.impact.drives import RIGID, Drives
from hitjoints.loading.catalogue import robot_names
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact, Robot
from hitjoints.vectors import number, positive_per_joint, whole

Offset = tuple[float, float, float]
MOST_HITS = 6
"""Of a sequence."""
TOLERANCE = 0.05
"""m, how far from the goal counts as there."""


@dataclass(frozen=True)
class RobotChoice:
    """What `load_robot` takes.

    Attributes:
        source: name or path.
        tip: as `load_robot`; None and empty are the usual.
        base: as `load_robot`; None and empty are the usual.
        lock: as `load_robot`; None and empty are the usual.
        tool: as `load_robot`; None and empty are the usual.
        package_dirs: as `load_robot`; None and empty are the usual.
        xacro_args: as `load_robot`; None and empty are the usual.
    """

    source: str = "iiwa14"
    tip: str | None = None
    base: str | None = None
    lock: Mapping[str, float] = field(default_factory=dict)
    tool: str | None = None
    package_dirs: tuple[str, ...] = ()
    xacro_args: Mapping[str, str] = field(default_factory=dict)

    def load(self) -> Robot:
        """Load the arm; errors as `load_robot`."""
        return load_robot(
            self.source,
            self.tip,
            self.base,
            self.lock,
            self.tool,
            self.package_dirs,
            self.xacro_args or None,
        )

    def seen_from(self, folder: Path) -> RobotChoice:
        """Return the choice with its paths, relative to here, as they are seen from a folder."""
        here = Path(os.path.abspath(folder))
        return self._with_paths(lambda path: os.path.relpath(path, here))

    def found_from(self, folder: Path) -> RobotChoice:
        """Return the choice with its paths, relative to a folder, as they are seen from here."""
        return self._with_paths(lambda path: os.path.normpath(os.path.join(folder, path)), folder)

    def _with_paths(self, move: Any, folder: Path = Path()) -> RobotChoice:
        is_name = self.source in robot_names() or not os.path.isfile(folder / self.source)
        return replace(
            self,
            source=self.source if is_name else move(self.source),
            tool=None if self.tool is None else move(self.tool),
            package_dirs=tuple(move(path) for path in self.package_dirs),
        )


@dataclass(frozen=True)
class HitSetting:
    """The arm, the joints to try, the surroundings, and how the hit is planned and made.

    Attributes:
        robot: the arm; None where a function is given it.
        joints: 1-based, to try; None for the robot's hitting joints.
        offset: (3,) m, of the contact in each joint's frame, or one for each joint; None for the
            joint's origin, and for the tip of a tool when no joint is named either.
        object_size: (3,) m, edges of the object seen along the axes of the base frame; None for
            the box that the hit's size makes.
        table_height: m, z of the table's plane; None for no table.
        margin: m, clearance to keep; None to report it only.
        objective: of `plan`.
        deliverable: whether a flux is demanded of a motion from rest to rest; None where the
            drives' limits are known.
        away: whether the away condition (Eq. 14) is demanded.
        torque_limits: whether motions keep the motors' torque limits.
        seed: of everything random.
        dt: s, of motions; None for their own.
        q0: (n,) rad, where motions start; None for what suits each.
        q_hit: (n,) rad, where they strike; None for what suits.
        acceleration: rad/s^2, limits of the drives, one or (n,); None for the robot's.
        jerk: rad/s^3, likewise.
        drives: the model of the arm's drives that inertia and flux are reckoned with.
        hits: how many hits the object may take to its goal.
        tolerance: m, how far from the goal counts as there.

    Raises:
        InputError: hits or tolerance out of their range.
    """

    robot: RobotChoice | None = None
    joints: tuple[int, ...] | None = None
    offset: Offset | tuple[Offset, ...] | None = None
    object_size: tuple[float, float, float] | None = None
    table_height: float | None = None
    margin: float | None = None
    objective: str = "inertia"
    deliverable: bool | None = None
    away: bool = True
    torque_limits: bool = False
    seed: int = 0
    dt: float | None = None
    q0: tuple[float, ...] | None = None
    q_hit: tuple[float, ...] | None = None
    acceleration: float | tuple[float, ...] | None = None
    jerk: float | tuple[float, ...] | None = None
    drives: Drives = RIGID
    hits: int = 1
    tolerance: float = TOLERANCE

    def __post_init__(self) -> None:
        whole(self.hits, "hits", 1, MOST_HITS)
        number(self.tolerance, "tolerance", "it is above 0 m", lambda value: value > 0)
        if for_each(self.offset):
            count = len(self.joints or ())
            if len(self.offset or ()) != count:
                expected = f"one for all, or one for each of the {count} joints that are named"
                raise InputError("offset", self.offset, expected)

    def told(self, *names: str) -> dict[str, Any]:
        """Return what is told of these, by name, for a function that knows the usual itself."""
        values = {name: getattr(self, name) for name in names}
        return {name: value for name, value in values.items() if value is not None}

    def arm(self, robot: Robot | None = None) -> Robot:
        """Return the arm, with the limits of its drives that are told.

        Args:
            robot: it, if it is loaded already.

        Raises:
            InputError: it is not told with which arm, or it cannot be loaded.
        """
        if robot is None:
            if self.robot is None:
                raise InputError("robot", None, "the hit does not say with which arm")
            robot = self.robot.load()
        told = {"acceleration": self.acceleration, "jerk": self.jerk}
        limits: dict[str, Any] = {
            name: positive_per_joint(value, robot.n, name)
            for name, value in told.items()
            if value is not None
        }
        return replace(robot, **limits) if limits else robot


def setting_of(robot: Robot, contacts: Sequence[Contact] | None) -> HitSetting:
    """Return what a hit keeps of an arm, and of the contacts to try; None for the arm's own."""
    offsets = tuple(contact.offset for contact in contacts or ())
    return HitSetting(
        None if robot.asked is None else RobotChoice(**robot.asked),
        None if contacts is None else tuple(contact.joint for contact in contacts),
        offsets[0] if len(set(offsets)) == 1 else offsets or None,
    )


def offsets_of(offset: Offset | tuple[Offset, ...] | None, count: int) -> tuple[Offset, ...]:
    """Return the offset of each of so many joints, from one for all or one for each."""
    if offset is None:
        return ((0.0, 0.0, 0.0),) * count
    return offset if for_each(offset) else (offset,) * count  # type: ignore[return-value]


def for_each(offset: Offset | tuple[Offset, ...] | None) -> bool:
    """Tell whether there is an offset for each joint, not one for all."""
    return any(isinstance(part, (tuple, list)) for part in offset or ())


USUAL = HitSetting()
