"""A rollout's data set, read again as a motion."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.hit import Hit
from hitjoints.model.robot import Contact
from hitjoints.show.viewer.clip import Clip, shares_of

if TYPE_CHECKING:
    from hitjoints.model.robot import Robot

NEEDED = ("robot", "joint", "contact_offset", "object_position", "direction", "mass")


def read_rollout(path: Path) -> tuple[str, int, Hit, Callable[[Robot], Clip]]:
    """Return the arm's name and number of joints, the hit, and what makes the arm's motion.

    Raises:
        InputError: it is no data set that `rollout --out` wrote.
    """
    import xarray as xr

    try:
        engine: Any = "zarr" if path.suffix == ".zarr" else "h5netcdf"
        options: dict[str, Any] = {"consolidated": False} if engine == "zarr" else {}
        with xr.open_dataset(path, engine=engine, **options) as held:
            rows = {name: np.array(held[name]) for name in ("time", "q", "qd", "torque")}
            said = dict(held.attrs)
        hit = _hit(said)
        impact, speed = float(said["impact_time"]), float(said["impact_speed"])
    except (OSError, KeyError, ValueError, TypeError) as error:
        if isinstance(error, InputError):
            raise
        reason = f"it is no rollout that hits something ({type(error).__name__}: {error})"
        raise InputError("file", path, reason) from None

    def clip(robot: Robot) -> Clip:
        why = "; ".join(filter(None, (str(said.get("reason", "")), str(said.get("why", "")))))
        shares = shares_of(robot, rows["qd"], rows["torque"])
        motion = rows["time"], rows["q"], impact, speed
        return Clip("rollout", hit, *motion, why=why, shares=shares)

    return str(said["robot"]), rows["q"].shape[1], hit, clip


def _hit(said: dict[str, Any]) -> Hit:
    """Return the hit that the attributes tell."""
    missing = [name for name in NEEDED if name not in said]
    if missing:
        raise KeyError(missing[0])
    x, y, z = (float(value) for value in np.atleast_1d(said["contact_offset"]))
    return Hit(
        Contact(int(said["joint"]), (x, y, z)),
        np.array(said["object_position"], dtype=float),
        np.array(said["direction"], dtype=float),
        float(said["mass"]),
        float(said["desired_flux"]) if "desired_flux" in said else None,
    )
