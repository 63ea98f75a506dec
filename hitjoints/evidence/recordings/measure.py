"""One recorded hit: the robot at the contact, the object after it, and what follows from both."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.evidence.recordings import fits
from hitjoints.evidence.recordings.alignment import SAME_ROBOT
from hitjoints.evidence.recordings.contact import NotHitError, Touch, from_object, from_robot
from hitjoints.evidence.recordings.csv_table import RecordingError
from hitjoints.evidence.recordings.glide import measure_glide
from hitjoints.evidence.recordings.hit_files import FoundFiles
from hitjoints.evidence.recordings.layout import ObjectRecording, RobotRecording, read_object
from hitjoints.evidence.recordings.motion import RecordedMotion
from hitjoints.evidence.recordings.replayed_hit import ReplayedHit, Series
from hitjoints.impact.collision import hitting_flux

if TYPE_CHECKING:
    pass

DEFAULT_MASS = 0.4
"""kg, of object 1 of the public data set."""

MOVING = 0.1
"""m/s: rows that are slower say little about the mass that a flux implies."""


DOUBTFUL_VELOCITY, DOUBTFUL_FLUX = 0.05, 1e-3
"""m/s: greater errors are pointed out."""


class Blow(NamedTuple):
    """The robot at the contact: time (s), the object's mass, inertia (kg), speed and flux (m/s)."""

    time: float
    mass: float
    inertia: float
    speed: float
    flux: float


def measure(
    found: FoundFiles,
    recording: RobotRecording,
    motion: RecordedMotion,
    robot: str,
    mass: float | None,
) -> ReplayedHit:
    """Measure one hit; the prediction is added when all are measured.

    Args:
        found: its files.
        recording: what the robot's holds.
        motion: the model along it.
        robot: its name.
        mass: kg; None: the one that the recorded flux implies, or the default.

    Raises:
        RecordingError: the object was not hit, or the robot's speed at the contact is not known.
    """
    notes = list(recording.notes)
    track = _track(found, notes)
    touch = _touch(recording, motion, track, notes)
    now = touch.time
    try:
        speed = float(fits.before(motion.clock, motion.speed, now).at(now)[0])
    except RecordingError as error:
        raise RecordingError(f"robot_speed: {error}") from None
    if not speed > 0:
        raise RecordingError(f"the robot does not move along the direction ({speed:.3g} m/s)")
    inertia = float(motion.at(now, motion.inertia)[0])
    if not np.isfinite(inertia):
        raise RecordingError("the robot cannot move along the direction at the contact")
    weight, source = _mass(motion, mass)
    blow = Blow(now, weight, inertia, speed, hitting_flux(inertia, weight, speed))
    lag, hit_time = motion.lag, recording.hit_time
    values = _recorded(motion, blow, notes) | _after(motion, track, blow, notes)
    notes += _doubts(motion, values.get("recorded_flux_error"), weight)
    return ReplayedHit(
        file=str(found.file),
        robot=robot,
        ok=True,
        reason="; ".join(notes),
        object_file=None if found.object_file is None else str(found.object_file),
        mass=weight,
        mass_source=source,
        direction=motion.direction.tolist(),
        lag=None if lag is None else lag.rows,
        lag_steps=None if lag is None else [list(step) for step in lag.steps],
        position_error=None if lag is None else lag.greatest,
        velocity_error=motion.velocity_error,
        contact_time=now - float(motion.clock.time[0]),
        contact_source=touch.source,
        hit_time_delay=None if hit_time is None else hit_time - now,
        inertia=inertia,
        gradient=motion.at(now, motion.gradient).tolist(),
        robot_speed=speed,
        flux=blow.flux,
        desired_flux=recording.desired_flux,
        series=_series(motion, now),
        **values,
    )


def predict(hits: list[ReplayedHit], restitution: float | None) -> tuple[ReplayedHit, ...]:
    """Return the hits with the object's predicted speed.

    Args:
        hits: measured ones.
        restitution: None: for each hit the median of what was found in the others.
    """
    known = np.sort([hit.restitution for hit in hits if hit.restitution is not None])
    predicted = []
    for hit in hits:
        assumed = restitution
        if assumed is None:
            own = [] if hit.restitution is None else [np.searchsorted(known, hit.restitution)]
            others = np.delete(known, own)
            assumed = float(np.median(others)) if len(others) else None
        if hit.flux is None or assumed is None:
            predicted.append(hit)
            continue
        speed = (1 + assumed) * hit.flux
        predicted.append(replace(hit, assumed_restitution=assumed, predicted_object_speed=speed))
    return tuple(predicted)


def _track(found: FoundFiles, notes: list[str]) -> ObjectRecording | None:
    if found.object_file is None:
        notes.append(f"no object quantities: {found.no_object}")
        return None
    try:
        track = read_object(found.object_file)
    except RecordingError as error:
        notes.append(f"no object quantities: {found.object_file.name}: {error}")
        return None
    notes += [f"{found.object_file.name}: {note}" for note in track.notes]
    return track


def _touch(
    recording: RobotRecording,
    motion: RecordedMotion,
    track: ObjectRecording | None,
    notes: list[str],
) -> Touch:
    """Return the first touch by the object's motion, or else by the robot's."""
    why = ""
    if track is not None:
        try:
            return from_object(track.clock, track.position, motion.direction)
        except NotHitError:
            raise
        except RecordingError as error:
            why = f"{error}; "
            notes.append(f"contact told by the robot's loss of speed: {error}")
    try:
        return from_robot(motion.clock, motion.speed, recording.hit_time)
    except RecordingError as error:
        raise RecordingError(f"{why}{error}") from None


def _mass(motion: RecordedMotion, mass: float | None) -> tuple[float, str]:
    """Return the object's mass: given, implied by the recorded flux, or the default."""
    if mass is not None:
        return mass, "given"
    inertia, rows = motion.recorded_inertia, motion.recorded
    if inertia is not None and "HittingFlux" in rows and "EEF_Velocity" in rows:
        speed, flux = np.linalg.norm(rows["EEF_Velocity"], axis=1), rows["HittingFlux"][:, 0]
        moving = (speed > MOVING) & (flux > 0)
        if moving.any():
            implied = float(np.median(inertia[moving] * (speed[moving] / flux[moving] - 1)))
            if implied > 0:
                return implied, "recorded"
    return DEFAULT_MASS, "default"


def _recorded(motion: RecordedMotion, blow: Blow, notes: list[str]) -> dict[str, Any]:
    """Return the recorder's own quantities at the contact, and whether they agree among them."""
    found: dict[str, Any] = {}
    inertia, rows = motion.recorded_inertia, motion.recorded
    if inertia is not None:
        found["recorded_inertia"] = float(motion.at(blow.time, inertia)[0])
    elif "Inertia" in rows:
        notes.append("recorded_inertia: Inertia is not positive along the direction")
    if "DirGrad" in rows:
        found["recorded_gradient"] = motion.at(blow.time, rows["DirGrad"]).tolist()
    if "HittingFlux" in rows:
        flux = rows["HittingFlux"][:, 0]
        found["recorded_flux"] = float(motion.at(blow.time, flux)[0])
        if inertia is not None and "EEF_Velocity" in rows:
            speed = np.linalg.norm(rows["EEF_Velocity"], axis=1)
            apart = hitting_flux(inertia, blow.mass, speed) - flux
            found["recorded_flux_error"] = float(np.abs(apart).max())
    return found


def _doubts(motion: RecordedMotion, flux_error: float | None, mass: float) -> list[str]:
    """Return what does not agree with itself, although the recording is this robot's."""
    doubts, lag, velocity = [], motion.lag, motion.velocity_error
    if lag is not None and lag.steps:
        steps = ", ".join(f"{step.lag} from row {step.row} on" for step in lag.steps)
        doubts.append(f"lag: it steps within the recording, {steps}: a message was dropped")
    if lag is not None and lag.greatest > SAME_ROBOT:
        doubts.append(f"position_error: the tool is {lag.greatest:.2g} m off in some rows")
    if velocity is not None and velocity > DOUBTFUL_VELOCITY:
        doubts.append(f"velocity_error: the velocity is {velocity:.2g} m/s off in some rows")
    if flux_error is not None and flux_error > DOUBTFUL_FLUX:
        doubts.append(
            f"recorded_flux_error: HittingFlux is {flux_error:.2g} m/s off that of its own inertia "
            f"and {mass:.3g} kg"
        )
    return doubts


def _after(
    motion: RecordedMotion, track: ObjectRecording | None, blow: Blow, notes: list[str]
) -> dict[str, Any]:
    """Return what is measured after the contact, and what follows from it."""
    found: dict[str, Any] = {}
    try:
        line = fits.after(motion.clock, motion.speed, blow.time)
        found["robot_speed_after"] = float(line.at(blow.time + fits.PUSH)[0])
        start = fits.before(motion.clock, motion.speed, blow.time)
        found["robot_acceleration"] = float(line.slope[0] + start.slope[0]) / 2
    except RecordingError as error:
        notes.append(f"robot_speed_after: {error}")
    if track is None:
        return found
    try:
        glide = measure_glide(track.clock, track.position, motion.direction, blow.time)
    except RecordingError as error:
        notes.append(f"object_speed: {error}")
        return found
    if glide.no_friction:
        notes.append(glide.no_friction)
    found |= {
        "object_speed": glide.speed,
        "object_time": glide.time,
        "object_direction_error": glide.direction_error,
        "restitution": glide.speed / blow.flux - 1,
        "travel": glide.travel,
        "came_to_rest": glide.came_to_rest,
        "friction": glide.friction,
    }
    if glide.friction is not None:
        taken = glide.friction * GRAVITY * glide.time
        found["restitution_at_contact"] = (glide.speed + taken) / blow.flux - 1
    if "robot_speed_after" in found:
        lost = blow.speed - found["robot_speed_after"]
        if lost > 0:
            balance = blow.mass * glide.speed / lost
            found |= {"momentum_mass": balance, "momentum_ratio": balance / blow.inertia}
        else:
            notes.append("momentum_mass: the robot is not slower after the contact")
        unpushed = lost + found["robot_acceleration"] * fits.PUSH
        if unpushed > 0:
            found["unpushed_mass"] = blow.mass * glide.speed / unpushed
    return found


def _series(motion: RecordedMotion, now: float) -> Series:
    recorded = np.full(len(motion.inertia), np.nan)
    inertia = motion.recorded_inertia
    if inertia is not None:
        recorded[: len(inertia)] = inertia
    return Series(motion.clock.time - now, motion.inertia, motion.gradient, motion.speed, recorded)
