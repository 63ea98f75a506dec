"""What a file holds that can be shown: a hit, a plan, or a motion; the file tells itself which."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import jacobian
from hitjoints.errors import InputError
from hitjoints.evidence.recordings.csv_table import TIME
from hitjoints.export.trajectory_reading import read_trajectory
from hitjoints.hit_loading import hit_of, load_hit
from hitjoints.hit_setting import RobotChoice
from hitjoints.loading.catalogue import robot_names
from hitjoints.planning.plan_file import load_plan
from hitjoints.show.viewer.clip import Clip, shares_of
from hitjoints.show.viewer.recorded_clip import recorded_clip, recorded_robot
from hitjoints.show.viewer.rollout_file import read_rollout

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.planning.plan_record import Plan

KINDS = "a hit.toml, a plan.json, a trajectory (.csv, .npz, .json), a rollout (.zarr, .nc), or a "
KINDS += "recorded hit (.csv)"


@dataclass(frozen=True, eq=False)
class ShownFile:
    """What a file holds.

    Attributes:
        robot: the arm that it is for; None where it does not say.
        hit: that it is about; None where the motion alone tells it.
        plan: if it is one.
        clip: makes the motion for the arm, if it is one.
    """

    robot: RobotChoice | None
    hit: Hit | None = None
    plan: Plan | None = None
    clip: Callable[[Robot], Clip] | None = None


def read_shown(path: Path) -> ShownFile:
    """Read a file.

    Raises:
        InputError: it holds nothing that can be shown.
    """
    if not path.exists():
        raise InputError("file", path, "there is no such file")
    if path.suffix == ".toml":
        hit = load_hit(path)
        return ShownFile(hit.setting.robot, hit)
    if path.suffix in (".zarr", ".nc"):
        name, n, hit, clip = read_rollout(path)
        return ShownFile(_choice(name), hit, clip=_for_joints(path, n, clip))
    if path.suffix == ".json" and _keys(path) >= {"candidates", "best"}:
        plan = load_plan(path)
        return ShownFile(plan.hit.setting.robot, plan.hit, plan)
    if path.suffix == ".csv" and _is_recording(path):
        return ShownFile(
            _choice(recorded_robot(path)), clip=lambda robot: recorded_clip(path, robot)
        )
    if path.suffix in (".csv", ".npz", ".json"):
        return _trajectory(path)
    raise InputError("file", path, f"one of these is needed: {KINDS}")


def _keys(path: Path) -> set[str]:
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise InputError("file", path, f"it is no JSON ({error})") from None
    return set(held) if isinstance(held, dict) else set()


def _is_recording(path: Path) -> bool:
    try:
        with path.open(encoding="utf-8-sig") as file:
            return any(TIME in file.readline() for _ in range(2))
    except (OSError, UnicodeDecodeError):
        return False


def _choice(name: str | None) -> RobotChoice | None:
    return RobotChoice(name) if name in robot_names() else None


def _trajectory(path: Path) -> ShownFile:
    found = read_trajectory(path)
    if "hit" not in found.notes or "impact_time" not in found.notes:
        raise InputError("file", path, "the trajectory does not say which hit it makes")
    hit = hit_of(found.notes["hit"], path)
    impact = float(found.notes["impact_time"])

    def clip(robot: Robot) -> Clip:
        row = int(np.argmin(np.abs(found.time - impact)))
        velocity = jacobian(robot, found.q[row], hit.chosen_contact) @ found.qd[row]
        shares = shares_of(robot, found.qd, found.torque)
        speed = float(hit.direction @ velocity)
        return Clip("swing", hit, found.time, found.q, impact, speed, why=found.why, shares=shares)

    choice = hit.setting.robot or _choice(found.notes.get("robot"))
    return ShownFile(choice, hit, clip=_for_joints(path, found.q.shape[1], clip))


def _for_joints(path: Path, n: int, make: Callable[[Robot], Clip]) -> Callable[[Robot], Clip]:
    """Return what makes a motion, and refuses an arm with another number of joints."""

    def clip(robot: Robot) -> Clip:
        if robot.n != n:
            raise InputError("file", path, f"it moves {n} joints, and {robot.name} has {robot.n}")
        return make(robot)

    return clip
