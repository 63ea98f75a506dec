"""Read a trajectory's file again: CSV, NPZ, or the ROS message as JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.export.trajectory import Trajectory, read_trajectory_csv

READABLE = (".csv", ".npz", ".json")
STATE = "not sendable: "


def read_trajectory(path: Path | str) -> Trajectory:
    """Read what `write_trajectory` wrote, but for its YAML.

    Args:
        path: of the file, .csv, .npz or .json.

    Raises:
        InputError: it is no such file.
    """
    path = Path(path)
    read = {".csv": _csv, ".npz": _npz, ".json": _json}.get(path.suffix)
    if read is None:
        raise InputError("path", path, f"a trajectory is read from {', '.join(READABLE)}")
    try:
        found = read(path)
        shapes = {rows.shape for rows in found.columns().values()}
        if shapes != {(len(found.time), len(found.names))} or not len(found.time):
            raise ValueError("its rows are of different lengths")
        if (np.diff(found.time) <= 0).any():
            raise ValueError("its times do not ascend")
        return found
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError("path", path, f"it is no trajectory ({error})") from None


def _csv(path: Path) -> Trajectory:
    time, columns = read_trajectory_csv(path)
    notes: dict[str, Any] = {}
    names: tuple[str, ...] = tuple(f"joint {i + 1}" for i in range(columns["q"].shape[1]))
    why = ""
    with path.open(encoding="utf-8") as file:
        for line in file:
            if not line.startswith("# "):
                break
            name, _, value = line[2:].strip().partition(": ")
            if name == "joints":
                names = tuple(value.split(", "))
            elif name.startswith("hitjoints, "):
                why = value
            else:
                notes[name] = json.loads(value)
    return Trajectory(names, time, *_rows(columns), why, notes)


def _npz(path: Path) -> Trajectory:
    with np.load(path) as held:
        columns = {name: held[name] for name in ("q", "qd", "qdd", "tau")}
        notes = json.loads(str(held["notes"]))
        names, time = tuple(map(str, held["joint_names"])), held["time"]
    return Trajectory(names, time, *_rows(columns), *_told(notes))


def _json(path: Path) -> Trajectory:
    message = json.loads(path.read_text(encoding="utf-8"))
    points = message["points"]
    stamps = [point["time_from_start"] for point in points]
    time = np.array([stamp["sec"] + 1e-9 * stamp["nanosec"] for stamp in stamps])
    keys = {"q": "positions", "qd": "velocities", "qdd": "accelerations", "tau": "effort"}
    columns = {
        name: np.array([point[key] for point in points], dtype=float) for name, key in keys.items()
    }
    names = tuple(message["joint_names"])
    return Trajectory(names, time, *_rows(columns), *_told(message.get("hitjoints", {})))


def _rows(columns: dict[str, Any]) -> tuple[Any, Any, Any, Any]:
    return columns["q"], columns["qd"], columns["qdd"], columns["tau"]


def _told(notes: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return why it cannot be sent, and the other notes."""
    others = {name: value for name, value in notes.items() if name not in ("sendable", "why")}
    return str(notes.get("why", "")), others
