"""What is found in one recorded hit."""

from __future__ import annotations

from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hitjoints.evidence.recordings.shown_mass import ShownMass
    from hitjoints.types import Array


@dataclass(frozen=True, eq=False)
class Series:
    """Along the motion, for figures and data sets.

    Attributes:
        time: (N,) s from the contact.
        inertia: (N,) kg.
        gradient: (N, n) kg/rad.
        speed: (N,) m/s along the direction.
        recorded_inertia: (N,) kg, nan where the recorder has none.
    """

    time: Array
    inertia: Array
    gradient: Array
    speed: Array
    recorded_inertia: Array


@dataclass(frozen=True, eq=False)
class ReplayedHit:
    """A recorded hit beside the model; what could not be determined is None, and `reason` says why.

    Attributes:
        file: paths.
        object_file: paths.
        robot: name of the arm.
        ok: robot_speed, inertia and flux at the contact were determined.
        reason: why not, or what is missing; empty if all is there.
        mass: kg, of the object.
        mass_source: given, recorded (what HittingFlux implies) or default.
        direction: hitting direction, robot base frame.
        lag: rows by which the recorder's quantities lag the joints, in most rows.
        lag_steps: the recorder's rows from which on the lag is another, each with that lag.
        position_error: m, greatest distance between model and recording after the lag; None if not
            recorded.
        velocity_error: m/s, greatest distance between model and recording after the lag; None if
            not recorded.
        contact_time: s after the file's first row.
        contact_source: object (it starts to move) or robot (it loses speed).
        hit_time_delay: s, from the contact to the recorder's HitTime.
        inertia: kg, of the model at the contact.
        gradient: (n,) kg/rad.
        recorded_inertia: the recorder's, of its own model.
        recorded_gradient: the recorder's, of its own model.
        robot_speed: m/s, before the contact, along the direction.
        robot_speed_after: once the robot no longer pushes.
        flux: m/s, of the model's inertia and robot_speed (Eq. 4).
        recorded_flux: HittingFlux.
        recorded_flux_error: m/s, greatest distance between HittingFlux and Eq. 4 with the
            recorder's own inertia and length of the velocity.
        desired_flux: m/s, of the file's first line.
        object_speed: m/s, after the hit.
        object_time: s from the contact to where it is measured.
        object_direction_error: deg.
        restitution: object_speed / flux - 1 (Eq. 3).
        restitution_at_contact: the same, with what friction took until object_time given back.
        assumed_restitution: that of the prediction.
        predicted_object_speed: m/s.
        momentum_mass: kg, mass object_speed / (robot_speed - robot_speed_after): no inertia of the
            robot, which pushes on during the contact.
        momentum_ratio: to inertia.
        robot_acceleration: m/s^2, along the direction, the mean of before the contact and after it:
            the controller's.
        unpushed_mass: kg, as momentum_mass, with the speed that this gives the robot meanwhile
            taken off.
        shown_mass: by models of the drives; None where they were not asked for.
        travel: m, of the object.
        came_to_rest: within the recording.
        friction: coefficient of sliding friction.
        series: along the motion; None if there is no contact.
    """

    file: str
    robot: str | None = None
    ok: bool = False
    reason: str = ""
    object_file: str | None = None
    mass: float | None = None
    mass_source: str | None = None
    direction: list[float] | None = None
    lag: int | None = None
    lag_steps: list[list[int]] | None = None
    position_error: float | None = None
    velocity_error: float | None = None
    contact_time: float | None = None
    contact_source: str | None = None
    hit_time_delay: float | None = None
    inertia: float | None = None
    recorded_inertia: float | None = None
    gradient: list[float] | None = None
    recorded_gradient: list[float] | None = None
    robot_speed: float | None = None
    robot_speed_after: float | None = None
    flux: float | None = None
    recorded_flux: float | None = None
    recorded_flux_error: float | None = None
    desired_flux: float | None = None
    object_speed: float | None = None
    object_time: float | None = None
    object_direction_error: float | None = None
    restitution: float | None = None
    restitution_at_contact: float | None = None
    assumed_restitution: float | None = None
    predicted_object_speed: float | None = None
    momentum_mass: float | None = None
    momentum_ratio: float | None = None
    robot_acceleration: float | None = None
    unpushed_mass: float | None = None
    travel: float | None = None
    came_to_rest: bool | None = None
    friction: float | None = None
    shown_mass: ShownMass | None = None
    series: Series | None = field(default=None, repr=False)

    def as_dict(self) -> dict[str, Any]:
        """Return everything but the series, as JSON knows it."""
        kept = [item.name for item in fields(self) if item.name not in ("series", "shown_mass")]
        told = None if self.shown_mass is None else self.shown_mass.as_dict()
        return {name: getattr(self, name) for name in kept} | {"shown_mass": told}
