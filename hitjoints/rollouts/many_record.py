"""What many rollouts leave behind: arrays with a row for each."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.describe import origin
from hitjoints.told import Told

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from xarray import Dataset

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

    Flags = NDArray[np.bool_]
    Words = NDArray[np.object_]

UNITS = {
    "time": ("s", "time of the impact"),
    "position": ("m", "contact point at the impact, robot base frame"),
    "miss": ("m", "distance from there to the object"),
    "direction_error": ("deg", "angle between the contact's velocity and the direction"),
    "inertia": ("kg", "directional inertia at the impact"),
    "desired_inertia": ("kg", "directional inertia aimed for (Eq. 13)"),
    "speed": ("m/s", "speed of the contact along the direction at the impact"),
    "flux": ("m/s", "directional hitting flux at the impact"),
    "q": ("rad", "joint positions at the impact"),
    "q0": ("rad", "joint positions at the start"),
    "q_hit": ("rad", "hitting configuration it was prepared with"),
    "saturated": ("1", "the desired flux was out of reach at the impact"),
    "steps": ("1", "control steps until the impact"),
    "saturated_steps": ("1", "of these, slowed down by limits"),
    "braked_steps": ("1", "of these, without a certified motion"),
    "certified_steps": ("1", "of these, taken by the certifying way"),
    "velocity_ratio_max": ("1", "greatest velocity in units of its limit"),
    "position_violation_max": ("rad", "greatest distance beyond a position limit"),
    "torque_ratio_max": ("1", "greatest torque in units of its limit"),
    "acceleration_ratio_max": ("1", "greatest acceleration in units of its limit"),
}
"""Unit and long name of every array."""


@dataclass(frozen=True, eq=False, repr=False)
class Rollouts(Told):
    """What N rollouts come to; every array has a row for each, nan where there is no impact.

    Attributes:
        robot: the arm.
        hits: what was asked, N of them.
        reason: (N,) why it is no hit; empty for a hit.
        why: (N,) what keeps a controller from following it; empty when it is sendable.
        time: (N,) s, of the impact; this and the next as in `Impact`.
        position: (N, 3) m.
        miss: (N,) m.
        direction_error: (N,) deg.
        inertia: (N,) kg.
        desired_inertia: (N,) kg.
        speed: (N,) m/s.
        flux: (N,) m/s.
        q: (N, n) rad.
        saturated: (N,).
        q0: (N, n) rad, the starts.
        q_hit: (N, n) rad, the hitting configurations.
        steps: (N,) until the impact; this and the next as in `Rollout`.
        saturated_steps: (N,).
        braked_steps: (N,).
        certified_steps: (N,) of the steps, taken by the certifying way.
        velocity_ratio_max: (N,).
        position_violation_max: (N,) rad.
        torque_ratio_max: (N,).
        acceleration_ratio_max: (N,).
        parameters: of the controllers.
    """

    robot: Robot
    hits: tuple[Hit, ...]
    reason: Words
    why: Words
    time: Array
    position: Array
    miss: Array
    direction_error: Array
    inertia: Array
    desired_inertia: Array
    speed: Array
    flux: Array
    q: Array
    saturated: Flags
    q0: Array
    q_hit: Array
    steps: NDArray[np.int64]
    saturated_steps: NDArray[np.int64]
    braked_steps: NDArray[np.int64]
    certified_steps: NDArray[np.int64]
    velocity_ratio_max: Array
    position_violation_max: Array
    torque_ratio_max: Array
    acceleration_ratio_max: Array
    parameters: dict[str, Any] = field(default_factory=dict)

    @property
    def words(self) -> str:
        """What they come to, in a line."""
        made, sent = (sum(not one for one in row) for row in (self.reason, self.why))
        return f"{len(self.hits)} of {self.robot.name}: {made} hit, {sent} can be sent"

    def lines(self) -> list[tuple[str, object]]:
        """Return what is in the middle of them."""
        names = ("time", "miss", "direction_error", "inertia", "speed", "flux", "steps")
        rows = [(name, np.asarray(getattr(self, name), dtype=float)) for name in names]
        known = [(name, row[np.isfinite(row)]) for name, row in rows]
        return [(f"{name}, median", np.median(row) if row.size else None) for name, row in known]

    def __len__(self) -> int:
        """Return how many they are."""
        return len(self.hits)

    @property
    def hit(self) -> Flags:
        """(N,) whether each is the hit that was asked for."""
        return np.asarray(self.reason == "")

    @property
    def sendable(self) -> Flags:
        """(N,) whether each keeps all known limits and ends at rest."""
        return np.asarray(self.why == "")

    @property
    def within_limits(self) -> Flags:
        """(N,) whether each keeps the position limits, to rounding, and the velocity limits."""
        ratio, beyond = self.velocity_ratio_max, self.position_violation_max
        return np.asarray((ratio <= 1.0) & (beyond <= 0.0))

    @cached_property
    def dataset(self) -> Dataset:
        """One row per rollout; the same for the same input."""
        import xarray as xr

        further = {"position": ("coordinate",), "q": ("axis",), "q0": ("axis",), "q_hit": ("axis",)}
        variables: dict[str, Any] = {}
        for item in fields(self):
            if item.name in UNITS:
                unit, long_name = UNITS[item.name]
                axes = ("rollout", *further.get(item.name, ()))
                described = {"units": unit, "long_name": long_name}
                variables[item.name] = (axes, getattr(self, item.name), described)
        for name, told in (("reason", self.reason), ("why", self.why)):
            variables[name] = ("rollout", told.astype(str))
        coordinates = {"axis": np.arange(1, self.robot.n + 1)}
        return xr.Dataset(variables, coordinates, origin(self.robot) | self.parameters)
