"""A sampled motion, and its files: CSV, NPZ, and the ROS message JointTrajectory."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.files import check_writable, write_whole
from hitjoints.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from hitjoints.types import Array

TRAJECTORY_ENDINGS = (".csv", ".npz", ".yaml", ".json")
NUMBER = "%.16g"
"""Rounding to ten digits would already be hundreds of rad/s^3 of jerk."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A motion sampled at regular times.

    Attributes:
        names: of the joints, as in the robot's file.
        time: (N,) s, from 0.
        q: (N, n) rad, rad/s, rad/s^2, N m.
        qd: (N, n) rad, rad/s, rad/s^2, N m.
        qdd: (N, n) rad, rad/s, rad/s^2, N m.
        torque: (N, n) rad, rad/s, rad/s^2, N m.
        why: what keeps a controller from following it; empty if nothing does.
        notes: what else the files are to say, plain values by name.
    """

    names: tuple[str, ...]
    time: Array
    q: Array
    qd: Array
    qdd: Array
    torque: Array
    why: str = ""
    notes: dict[str, Any] = field(default_factory=dict)

    @property
    def state(self) -> str:
        """Whether it can be sent, in words."""
        return f"not sendable: {self.why}" if self.why else "sendable"

    def columns(self) -> dict[str, Array]:
        """Return the quantities of the joints by the names that files give them."""
        return {"q": self.q, "qd": self.qd, "qdd": self.qdd, "tau": self.torque}


def write_trajectory(trajectory: Trajectory, path: Path | str, argument: str = "out") -> None:
    """Write a trajectory, whole or not at all; the path's ending says how.

    `.csv` has one header line, `time,q1..qn,qd1..qdn,qdd1..qddn,tau1..taun`, after lines that begin
    with #; `.npz` the same arrays; `.yaml` and `.json` a trajectory_msgs/JointTrajectory.

    Args:
        trajectory: the motion.
        path: of the file.
        argument: that it was given as.

    Raises:
        InputError: another ending, or a path that cannot be written.
    """
    path = Path(path)
    check_writable(path, argument, TRAJECTORY_ENDINGS)
    write = {".csv": _csv, ".npz": _npz, ".yaml": _yaml, ".json": _json}[path.suffix]
    write_whole(path, argument, lambda made: write(trajectory, made))


def read_trajectory_csv(path: Path | str) -> tuple[Array, dict[str, Array]]:
    """Return time (N,) and q, qd, qdd, tau (N, n) by name, from a CSV file of a trajectory.

    Raises:
        InputError: it is no such file.
    """
    try:
        with Path(path).open(encoding="utf-8") as file:
            lines = [line for line in file if not line.startswith("#")]
        n = (len(lines[0].split(",")) - 1) // 4
        if lines[0].strip() != ",".join(_header(n)):
            raise ValueError("its header is another")
        rows = np.loadtxt(lines[1:], delimiter=",", ndmin=2)
        parts = np.split(rows[:, 1:], 4, axis=1)
    except (OSError, ValueError, IndexError) as error:
        raise InputError("path", path, f"it is no trajectory ({error})") from None
    return rows[:, 0], dict(zip(("q", "qd", "qdd", "tau"), parts, strict=True))


def _header(n: int) -> list[str]:
    names = (f"{name}{i}" for name in ("q", "qd", "qdd", "tau") for i in range(1, n + 1))
    return ["time", *names]


def _remarks(trajectory: Trajectory) -> Iterator[str]:
    yield f"# hitjoints, {trajectory.state}"
    yield f"# joints: {', '.join(trajectory.names)}"
    for name, value in trajectory.notes.items():
        yield f"# {name}: {json.dumps(value)}"


def _csv(trajectory: Trajectory, path: Path) -> None:
    rows = np.column_stack((trajectory.time, *trajectory.columns().values()))
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"{line}\n" for line in _remarks(trajectory))
        file.write(",".join(_header(trajectory.q.shape[1])) + "\n")
        np.savetxt(file, rows, fmt=NUMBER, delimiter=",")


def _npz(trajectory: Trajectory, path: Path) -> None:
    said = {"sendable": not trajectory.why, "why": trajectory.why, **trajectory.notes}
    np.savez_compressed(
        path,
        time=trajectory.time,
        joint_names=np.array(trajectory.names),
        notes=np.array(json.dumps(said)),
        **trajectory.columns(),  # type: ignore[arg-type]  # no array is called allow_pickle
    )


def _points(trajectory: Trajectory) -> Iterator[dict[str, Any]]:
    arrays = zip(
        trajectory.time, trajectory.q, trajectory.qd, trajectory.qdd, trajectory.torque, strict=True
    )
    for time, q, qd, qdd, torque in arrays:
        seconds, nanoseconds = divmod(round(1e9 * float(time)), 10**9)
        yield {
            "positions": q.tolist(),
            "velocities": qd.tolist(),
            "accelerations": qdd.tolist(),
            "effort": torque.tolist(),
            "time_from_start": {"sec": seconds, "nanosec": nanoseconds},
        }


def _json(trajectory: Trajectory, path: Path) -> None:
    said = {"sendable": not trajectory.why, "why": trajectory.why, **trajectory.notes}
    message = {
        "header": {"frame_id": ""},
        "joint_names": list(trajectory.names),
        "points": list(_points(trajectory)),
        "hitjoints": said,
    }
    path.write_text(json.dumps(message), encoding="utf-8")


def _yaml(trajectory: Trajectory, path: Path) -> None:
    """Write YAML by hand: JSON's lists and numbers are YAML, and a writer is not needed."""
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.writelines(f"{line}\n" for line in _remarks(trajectory))
        file.write('header:\n  frame_id: ""\njoint_names:\n')
        file.writelines(f"  - {json.dumps(name)}\n" for name in trajectory.names)
        file.write("points:\n")
        for point in _points(trajectory):
            mark = "-"
            for name, value in point.items():
                file.write(f"  {mark} {name}: {json.dumps(value)}\n")
                mark = " "
