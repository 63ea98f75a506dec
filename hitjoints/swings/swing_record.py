"""What a swing is: its joints along time, what they take of the limits, and what they strike."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hitjoints.datasets.describe import versions
from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.export.trajectory import Trajectory, write_trajectory
from hitjoints.impact.shown_inertia import shown_inertia
from hitjoints.plotted import Plotted
from hitjoints.swings.motion_limits import greatest_ratios, torques
from hitjoints.told import Told

if TYPE_CHECKING:
    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.swings.curves import Joints, Motion
    from hitjoints.types import Array

NOTED = ("hit", "impact_time", "flux", "unknown")
"""What of `as_dict` goes into a trajectory's file."""
TOLD = (
    *("sendable", "duration", "impact_time", "joint", "flux", "maximum_flux", "speed", "inertia"),
    *("velocity_ratio_max", "acceleration_ratio_max", "jerk_ratio_max", "torque_ratio_max"),
    *("clearance", "closest", "unknown"),
)
"""And into a table of it."""
RESTING = 1e-12
"""rad/s, a velocity that is none."""


@dataclass(frozen=True, eq=False, repr=False)
class Swing(Told, Plotted):
    """A motion from rest to rest that strikes on the way.

    Attributes:
        robot: what was asked; the hit has the contact and the flux that were chosen.
        hit: what was asked; the hit has the contact and the flux that were chosen.
        limits: that it keeps.
        motion: the joints at any time.
        dt: s, spacing of the samples.
        impact_sample: number of the sample at the impact, from 0.
        clearance: m, the least distance to anything on the way, None where shapes are not known.
        closest: of what that is.
        maximum_flux: m/s, the greatest that the samples could deliver, if limits alone counted.
        tried: what was in the way of other strokes -> how often.
        notes: what is not as asked for.
    """

    drawn_by: ClassVar[str] = "swing"

    robot: Robot
    hit: Hit
    limits: DriveLimits
    motion: Motion
    dt: float
    impact_sample: int
    clearance: float | None
    closest: str
    maximum_flux: float
    tried: dict[str, int] = field(default_factory=dict, repr=False)
    notes: tuple[str, ...] = ()

    @cached_property
    def times(self) -> Array:
        """(N,) s, whole multiples of dt from 0."""
        return np.asarray(
            self.dt * np.arange(math.ceil(self.motion.duration / self.dt - 1e-9) + 1.0)
        )

    @cached_property
    def joints(self) -> Joints:
        """q, qd, qdd and the jerk qddd, (N, n) each."""
        return self.motion.at(self.times)

    @cached_property
    def torque(self) -> Array:
        """(N, n) N m, those that turn the rotors included if these are known."""
        return torques(self.robot, self.limits, self.joints)

    @property
    def duration(self) -> float:
        """From rest to rest, s."""
        return float(self.times[-1])

    @property
    def impact_time(self) -> float:
        """When it strikes, s."""
        return float(self.times[self.impact_sample])

    @property
    def q0(self) -> Array:
        """Where it starts, (n,) rad."""
        return np.asarray(self.joints.q[0])

    @property
    def q_hit(self) -> Array:
        """Where it strikes, (n,) rad."""
        return np.asarray(self.joints.q[self.impact_sample])

    @property
    def qd_hit(self) -> Array:
        """How it strikes, (n,) rad/s."""
        return np.asarray(self.joints.qd[self.impact_sample])

    @cached_property
    def inertia(self) -> float:
        """Directional inertia at the impact by the model of the drives in the hit's setting, kg."""
        if self.hit.setting.drives.rigid:
            return self.links_inertia
        contact = self.robot.contact(self.hit.chosen_contact)
        return float(shown_inertia(self.robot, self.q_hit[None], contact, self.hit)[0])

    @cached_property
    def links_inertia(self) -> float:
        """Directional inertia of the links alone at the impact, kg."""
        contact = self.robot.contact(self.hit.chosen_contact)
        return inertia_along(self.robot, self.q_hit, contact, self.hit.direction)

    @cached_property
    def velocity(self) -> Array:
        """Of the contact at the impact, (3,) m/s."""
        return np.asarray(jacobian(self.robot, self.q_hit, self.hit.chosen_contact) @ self.qd_hit)

    @property
    def speed(self) -> float:
        """Of the contact at the impact along the direction, m/s."""
        return float(self.hit.direction @ self.velocity)

    @property
    def flux(self) -> float:
        """m/s, Eq. 4."""
        return self.hit.flux_of(self.inertia, self.speed)

    @property
    def miss(self) -> float:
        """Distance of the contact from the object at the impact, m."""
        where = position(self.robot, self.q_hit, self.hit.chosen_contact)
        return float(np.linalg.norm(where - self.hit.position))

    @property
    def ratios(self) -> tuple[float, float, float]:
        """Greatest velocity, acceleration and jerk in units of their limits."""
        return greatest_ratios(self.limits, self.joints)

    @property
    def torque_ratio_max(self) -> float:
        """Greatest torque in units of its limit; nan where none is known."""
        told = np.isfinite(self.limits.effort)
        if not told.any():
            return math.nan
        return float((np.abs(self.torque) / self.limits.effort)[:, told].max())

    @property
    def position_violation_max(self) -> float:
        """Greatest distance beyond a position limit, rad; 0 within them."""
        q = self.joints.q
        return float(np.maximum(self.robot.lower - q, q - self.robot.upper).max(initial=0.0))

    @cached_property
    def why(self) -> str:
        """What keeps a controller from following it; empty when it is sendable."""
        fast, hard, jerky = self.ratios
        checks = {
            "it does not start at rest": np.abs(self.joints.qd[0]).max() > RESTING,
            "it does not end at rest": np.abs(self.joints.qd[-1]).max() > RESTING,
            "positions are beyond their limits": self.position_violation_max > 0,
            "velocities are beyond their limits": fast > 1,
            "accelerations are beyond their limits": hard > 1,
            "jerks are beyond their limits": self.limits.jerk_known and jerky > 1,
            "torques are beyond their limits": self.torque_ratio_max > 1,
        }
        return "; ".join(words for words, broken in checks.items() if broken)

    @property
    def sendable(self) -> bool:
        """Starts and ends at rest, and keeps every known limit at every sample."""
        return not self.why

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it."""
        fast, hard, jerky = self.ratios
        torque = self.torque_ratio_max
        return {
            "sendable": self.sendable,
            "why": self.why,
            "duration": self.duration,
            "impact_time": self.impact_time,
            "dt": self.dt,
            "joint": self.hit.chosen_contact.joint,
            "offset": list(self.hit.chosen_contact.offset),
            "flux": self.flux,
            "maximum_flux": self.maximum_flux,
            "speed": self.speed,
            "inertia": self.inertia,
            "links_inertia": self.links_inertia,
            "impact": self.hit.setting.drives.model,
            "miss": self.miss,
            "q0": self.q0.tolist(),
            "q_hit": self.q_hit.tolist(),
            "qd_hit": self.qd_hit.tolist(),
            "velocity_ratio_max": fast,
            "acceleration_ratio_max": hard,
            "jerk_ratio_max": jerky if self.limits.jerk_known else None,
            "torque_ratio_max": None if math.isnan(torque) else torque,
            "position_violation_max": self.position_violation_max,
            "clearance": self.clearance,
            "closest": self.closest,
            "unknown": list(self.limits.unknown),
            "hit": self.hit.as_dict(),
            "made_with": versions(),
            "tried": self.tried,
            "notes": list(self.notes),
        }

    @property
    def words(self) -> str:
        """What it does, in a line."""
        state = "sendable" if self.sendable else f"not sendable: {self.why}"
        return (
            f"{self.robot.name}, joint {self.hit.chosen_contact.joint}: flux "
            f"{self.flux:.4g} m/s after {self.impact_time:.3f} s of {self.duration:.3f} s; {state}"
        )

    def lines(self) -> list[tuple[str, object]]:
        """Return what of it counts."""
        said = self.as_dict()
        return [(name, said[name]) for name in TOLD]

    @property
    def trajectory(self) -> Trajectory:
        """The samples, as files hold them."""
        joints, said = self.joints, self.as_dict()
        notes = {name: said[name] for name in NOTED} | {"robot": self.robot.name}
        notes["made_with"] = versions()
        names = tuple(self.robot.joint_names)
        rows = joints.q, joints.qd, joints.qdd, self.torque
        return Trajectory(names, self.times, *rows, self.why, notes)

    def save(self, path: Path | str) -> None:
        """Write the trajectory; see `write_trajectory`.

        Raises:
            InputError: an unknown ending, or a path that cannot be written.
        """
        seen = self.hit.seen_from(Path(path).parent).as_dict()
        told = self.trajectory
        write_trajectory(replace(told, notes=told.notes | {"hit": seen}), path, "path")
