"""What a rollout leaves behind: the state at the impact, and a data set with a row per step."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hitjoints.datasets.describe import origin, versions
from hitjoints.plotted import Plotted
from hitjoints.told import Told

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.hit import Hit
    from hitjoints.hitting.approach import Impact
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

AT_REST = 1e-9
"""rad/s, slower than that an arm has stopped."""

VARIABLES = {
    "q": ("rad", "joint positions (m for a prismatic joint)", ("axis",)),
    "qd": ("rad/s", "joint velocities from here to the next row", ("axis",)),
    "torque": (
        "N m",
        "joint torques that reach qd from the row before, at first from rest",
        ("axis",),
    ),
    "position": ("m", "contact point, robot base frame", ("coordinate",)),
    "inertia": ("kg", "directional inertia along the hitting direction", ()),
    "desired_inertia": ("kg", "directional inertia aimed for (Eq. 13)", ()),
    "speed": ("m/s", "speed of the contact along the hitting direction", ()),
    "flux": ("m/s", "directional hitting flux", ()),
    "scaling": ("1", "share of the field's speed within the limits", ()),
    "saturated": ("1", "the desired flux was out of reach", ()),
    "braked": ("1", "no motion was certified", ()),
    "emergency": ("1", "no way to rest within the limits was known", ()),
    "approach": ("1", "1 until the impact, 0 after it", ()),
    "position_margin": ("rad", "distance to the nearest position limit", ("axis",)),
    "velocity_margin": ("rad/s", "distance to the velocity limit", ("axis",)),
}
"""Unit, long name and further dimensions of every variable along time."""


@dataclass(frozen=True, eq=False, repr=False)
class Rollout(Told, Plotted):
    """A hit from its start to its end.

    Attributes:
        robot: what was asked.
        hit: what was asked.
        impact: None if the contact never reached the object's plane.
        reason: why it is no hit; empty for a hit.
        q_hit: (n,) rad, the hitting configuration it was prepared with.
        dt: s.
        steps: until the impact.
        saturated_steps: of these.
        braked_steps: of these.
        rows: name -> array along time, without `time`; see `VARIABLES`.
        step_times: (steps,) s, wall time of every control step.
        parameters: of the controller, kept in the data set.
    """

    drawn_by: ClassVar[str] = "rollout"

    robot: Robot
    hit: Hit
    impact: Impact | None
    reason: str
    q_hit: Array
    dt: float
    steps: int
    saturated_steps: int
    braked_steps: int
    rows: dict[str, Array]
    step_times: Array = field(repr=False)
    parameters: dict[str, Any] = field(default_factory=dict)

    @property
    def words(self) -> str:
        """What it comes to, in a line."""
        said = f"{self.robot.name}, joint {self.hit.chosen_contact.joint}: "
        at = self.impact
        if at is None or self.reason:
            return f"{said}no hit: {self.reason}"
        return (
            f"{said}flux {at.flux:.4g} of {self.hit.desired_flux:.4g} m/s after {at.time:.3f} s, "
            f"{1e3 * at.miss:.2g} mm and {at.direction_error:.2g} degrees off"
        )

    def lines(self) -> list[tuple[str, object]]:
        """Return what of it counts."""
        said = self.as_dict()
        told = {name: said[name] for name in said if not isinstance(said[name], (dict, list))}
        return [*(said["impact"] or {}).items(), *told.items()]

    @property
    def velocity_ratio_max(self) -> float:
        """Greatest |qd| in units of its limit; at most 1."""
        return self.robot.velocity_ratio(self.rows["qd"])

    @property
    def position_violation_max(self) -> float:
        """Greatest distance beyond a position limit, rad; 0 within them."""
        q = self.rows["q"]
        return float(np.maximum(self.robot.lower - q, q - self.robot.upper).max(initial=0.0))

    @property
    def torque_ratio_max(self) -> float:
        """Greatest |torque| in units of its limit; nan if the robot has no effort limits.

        Without torque limits the arm is thought to reach any velocity within a step, whatever that
        takes: this says what.
        """
        effort = self.robot.effort
        told = np.isfinite(effort) & (effort > 0)
        ratios = np.abs(self.rows["torque"][:, told]) / effort[told]
        return float(ratios.max()) if told.any() else math.nan

    @property
    def acceleration_ratio_max(self) -> float:
        """Greatest change of a velocity from step to step, in units of the acceleration limit.

        The first is that from rest. The limits are those that were kept, else the robot's; nan if
        it does not tell them.
        """
        kept = self.parameters.get("acceleration_limits")
        most = np.array(kept) if kept else self.robot.acceleration
        if most is None:
            return math.nan
        steps = np.diff(self.rows["qd"], axis=0, prepend=0.0)
        return float(np.max(np.abs(steps) / (self.dt * most)))

    @property
    def why(self) -> str:
        """What keeps a controller of the real arm from following it; empty when it is sendable."""
        return why_not_sendable(
            self.acceleration_ratio_max,
            self.torque_ratio_max,
            float(np.abs(self.rows["qd"][-1]).max()),
        )

    @property
    def sendable(self) -> bool:
        """It keeps all known limits, of accelerations and torques too, and ends at rest."""
        return not self.why

    @cached_property
    def dataset(self) -> Dataset:
        """One row per step, until the arm rests after the impact; the same for the same input."""
        import xarray as xr

        along = {}
        for name, (unit, long_name, more) in VARIABLES.items():
            attributes = {"units": unit, "long_name": long_name}
            along[name] = (("time", *more), self.rows[name], attributes)
        count = len(self.rows["q"])
        time = ("time", self.dt * np.arange(count), {"units": "s", "long_name": "time"})
        axis = ("axis", np.arange(1, self.robot.n + 1), {"units": "1", "long_name": "joint"})
        contact = self.robot.contact(self.hit.chosen_contact)
        asked: dict[str, Any] = {
            "joint": contact.joint,
            "contact_offset": list(contact.offset),
            "object_position": self.hit.position.tolist(),
            "direction": self.hit.direction.tolist(),
            "mass": float(self.hit.mass),
            "desired_flux": float(self.hit.desired_flux),
            "reason": self.reason,
            "sendable": int(self.sendable),
            "why": self.why,
        }
        if self.impact is not None:
            for name in ("time", "miss", "direction_error", "inertia", "speed", "flux"):
                asked[f"impact_{name}"] = float(getattr(self.impact, name))
        attributes = origin(self.robot) | asked | self.parameters
        return xr.Dataset(along, {"time": time, "axis": axis}, attributes)

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it; `step_time_us` differs from run to run."""
        impact: dict[str, Any] | None = None
        if self.impact is not None:
            impact = {
                k: getattr(v, "tolist", lambda v=v: v)() for k, v in vars(self.impact).items()
            }
        times = self.step_times if self.step_times.size else np.zeros(1)
        asked = self.parameters.get("hit")
        return {
            "asked": None if asked is None else json.loads(asked),
            "made_with": versions(),
            "impact": impact,
            "hit": not self.reason,
            "reason": self.reason,
            "steps": self.steps,
            "saturated_steps": self.saturated_steps,
            "braked_steps": self.braked_steps,
            "velocity_ratio_max": self.velocity_ratio_max,
            "position_violation_max": self.position_violation_max,
            "torque_ratio_max": self.torque_ratio_max,
            "acceleration_ratio_max": self.acceleration_ratio_max,
            "sendable": self.sendable,
            "why": self.why,
            "step_time_us": {
                "median": 1e6 * float(np.median(times)),
                "p99": 1e6 * float(np.percentile(times, 99)),
            },
            "q0": self.rows["q"][0].tolist(),
            "q_hit": self.q_hit.tolist(),
        }


def why_not_sendable(acceleration: float, torque: float, last: float) -> str:
    """Return what keeps a controller of the real arm from following a motion.

    Args:
        acceleration: greatest in units of the limits, nan if these are not known.
        torque: greatest in units of the limits, nan if these are not known.
        last: rad/s, the greatest velocity at its end.
    """
    told = {
        f"accelerations are up to {acceleration:.3g} times their limits": acceleration > 1,
        f"torques are up to {torque:.3g} times their limits": torque > 1,
        "it does not end at rest": last > AT_REST,
    }
    return "; ".join(words for words, broken in told.items() if broken)


def flattened(dataset: Dataset) -> Dataset:
    """Return a rollout's data set with a column per entry, q_1, q_2, ... for tables."""
    flat = dataset
    for name, variable in dataset.data_vars.items():
        if variable.ndim == 2:
            last = variable.dims[1]
            for i in range(variable.sizes[last]):
                column = variable.isel({last: i}).drop_vars([str(last)], errors="ignore")
                flat = flat.assign({f"{name}_{i + 1}": column})
            flat = flat.drop_vars([str(name)])
    return flat.drop_vars(["axis"], errors="ignore")
