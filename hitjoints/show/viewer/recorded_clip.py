"""A recorded hit as a motion: the arm's joints, and the object where it was seen."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InputError
from hitjoints.evidence.recordings.csv_table import RecordingError
from hitjoints.evidence.recordings.layout import read_object, read_robot
from hitjoints.evidence.recordings.replayer import KNOWN, TOOL, replay
from hitjoints.goals.slide_path import SlidePath
from hitjoints.hit import Hit
from hitjoints.model.robot import Contact
from hitjoints.show.viewer.clip import RECORDED, Clip, shares_of

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot

TELLING = 1e-3  # s, between two rows that tell a velocity
UNSEEN = "the object was not recorded: it slides as the model says"


def recorded_robot(path: Path) -> str | None:
    """Return the name of the arm that a recording is of, if it is a known one."""
    try:
        said = read_robot(path).name
    except RecordingError as error:
        raise InputError("file", path, str(error)) from None
    title = said or re.sub(r"_hit_.*", "", path.stem)
    return KNOWN[title][0] if title in KNOWN else None


def recorded_clip(path: Path, robot: Robot) -> Clip:
    """Return a recorded hit to play.

    Raises:
        InputError: the recording cannot be used.
    """
    found = replay(path, robot=robot).hits[0]
    if not found.ok or found.contact_time is None or found.mass is None:
        raise InputError("file", path, found.reason)
    recording = read_robot(path)
    stamps = recording.clock.time
    times, impact = stamps - stamps[0], found.contact_time
    contact = Contact(robot.n, TOOL)
    q = np.array([np.interp(impact, times, column) for column in recording.q.T])
    restitution, friction = found.restitution, found.friction
    hit = Hit(
        contact,
        position(robot, q, contact),
        np.array(found.direction),
        found.mass,
        found.flux,
        restitution=None if restitution is None else min(max(restitution, 0.0), 1.0),
        friction=friction if friction is not None and friction > 0 else None,
    )
    slide = None
    if found.object_file is not None:
        slide = _seen(Path(found.object_file), float(stamps[0]) + impact)
    return Clip(
        RECORDED,
        hit,
        times,
        recording.q,
        impact,
        found.robot_speed,
        slide,
        shares=shares_of(robot, recording.qd),
        note="" if slide is not None else UNSEEN,
    )


def _seen(path: Path, contact: float) -> SlidePath | None:
    """Return how the object was seen to move from a time (s) on, from where it was then."""
    try:
        track = read_object(path)
    except RecordingError:
        return None
    after = track.clock.time > contact
    if after.sum() < 2:
        return None
    at = np.array([np.interp(contact, track.clock.time, c) for c in track.position.T[:2]])
    times = np.append(0.0, track.clock.time[after] - contact)
    way = np.vstack((np.zeros(2), track.position[after, :2] - at))
    keep = np.append(True, np.diff(times) > TELLING)
    times, way = times[keep], way[keep]
    return SlidePath(times, way, np.gradient(way, times, axis=0), np.zeros(len(times)))
