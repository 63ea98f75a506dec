"""Recorded hits as an xarray data set: a value per hit, and the model along each motion."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.describe import PACKAGES
from hitjoints.version import __version__

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.evidence.recordings.replayed_hit import ReplayedHit

TEXTS = {
    "file": "robot's file",
    "object_file": "object's file",
    "robot": "name of the arm",
    "reason": "why a file cannot be used, or what is missing",
    "mass_source": "given, recorded (what the recorded flux implies) or default",
    "contact_source": "object (it starts to move) or robot (it loses speed)",
}
NUMBERS = {
    "ok": ("1", "the file could be used"),
    "mass": ("kg", "mass of the object"),
    "lag": ("1", "rows by which the recorder's quantities lag the joints"),
    "position_error": ("m", "greatest distance of the model's contact from the recorded one"),
    "velocity_error": ("m/s", "greatest distance of the model's velocity from the recorded one"),
    "contact_time": ("s", "first touch, from the file's first row"),
    "hit_time_delay": ("s", "from the first touch to the recorder's HitTime"),
    "inertia": ("kg", "directional inertia at the contact"),
    "recorded_inertia": ("kg", "the same, of the recorder's own model"),
    "robot_speed": ("m/s", "speed of the contact along the direction before the hit"),
    "robot_speed_after": ("m/s", "the same once the robot no longer pushes"),
    "flux": ("m/s", "directional hitting flux (Eq. 4)"),
    "recorded_flux": ("m/s", "the recorder's flux"),
    "recorded_flux_error": ("m/s", "greatest distance of the recorder's flux from its own Eq. 4"),
    "desired_flux": ("m/s", "the flux that was asked for"),
    "object_speed": ("m/s", "speed of the object along the direction after the hit"),
    "object_time": ("s", "from the first touch to where object_speed is measured"),
    "object_direction_error": ("deg", "between the object's velocity and the direction"),
    "restitution": ("1", "object_speed / flux - 1 (Eq. 3)"),
    "restitution_at_contact": ("1", "the same, without the friction until object_time"),
    "assumed_restitution": ("1", "restitution of the prediction"),
    "predicted_object_speed": ("m/s", "(1 + assumed_restitution) flux (Eq. 3)"),
    "momentum_mass": ("kg", "by the momentum balance: no inertia, the robot pushes on"),
    "momentum_ratio": ("1", "momentum_mass / inertia"),
    "travel": ("m", "how far the object slides"),
    "came_to_rest": ("1", "the object comes to rest within the recording"),
    "friction": ("1", "coefficient of sliding friction"),
}
ALONG = {
    "time": ("s", "from the first touch"),
    "inertia_along": ("kg", "directional inertia along the motion"),
    "recorded_inertia_along": ("kg", "the same, of the recorder's own model"),
    "speed_along": ("m/s", "speed of the contact along the direction"),
}


def hits_dataset(hits: Sequence[ReplayedHit], *, along: bool = True) -> Dataset:
    """Return the hits as a data set.

    Args:
        hits: of a replay.
        along: with inertia, gradient and speed along each motion, padded with nan.

    Returns:
        Dimensions hit, and with `along` row and axis. Text that is not known is empty.
    """
    import h5py
    import xarray as xr

    variables: dict[str, Any] = {}
    for name, what in TEXTS.items():
        words = np.array([getattr(hit, name) or "" for hit in hits], h5py.string_dtype())
        variables[name] = ("hit", words, {"long_name": what})
    for name, (unit, what) in NUMBERS.items():
        values = np.array([_number(getattr(hit, name)) for hit in hits])
        variables[name] = ("hit", values, {"units": unit, "long_name": what})
    if along:
        variables |= _along(hits)
    versions = ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES)
    attributes = {
        "Conventions": "CF-1.11",
        "title": "hitjoints: recorded hits",
        "source": f"hitjoints {__version__} ({versions})",
        "robots": sorted({hit.robot for hit in hits if hit.robot}),
    }
    number = ("hit", np.arange(len(hits)), {"units": "1", "long_name": "number of the hit"})
    return xr.Dataset(variables, {"hit": number}, attributes)


def _along(hits: Sequence[ReplayedHit]) -> dict[str, Any]:
    made = [(i, hit.series) for i, hit in enumerate(hits) if hit.series is not None]
    if not made:  # no motion could be read: no axes for what is along it
        return {}
    rows = max(len(series.time) for _, series in made)
    joints = max(series.gradient.shape[1] for _, series in made)
    arrays = {name: np.full((len(hits), rows), np.nan) for name in ALONG}
    gradient = np.full((len(hits), rows, joints), np.nan)
    for i, series in made:
        count, n = series.gradient.shape
        for name in ALONG:
            arrays[name][i, :count] = getattr(series, name.removesuffix("_along"))
        gradient[i, :count, :n] = series.gradient
    units = {"units": "kg/rad", "long_name": "gradient of the inertia by the joint positions"}
    return {
        name: (("hit", "row"), arrays[name], {"units": unit, "long_name": what})
        for name, (unit, what) in ALONG.items()
    } | {"gradient": (("hit", "row", "axis"), gradient, units)}


def _number(value: float | None) -> float:
    return np.nan if value is None else float(value)
