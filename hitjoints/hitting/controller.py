"""The controller of a hit: one joint velocity per step, from the present configuration (Eq. 5-13).

Use it in any loop that commands joint velocities:

    controller = Controller(robot, hit, q, dt=0.002)
    while not controller.arrived:
        command(controller.step(measured()))
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from hitjoints.dynamics.contact_point import ContactPoint, State
from hitjoints.errors import InputError, UnknownNameError
from hitjoints.hit import Hit
from hitjoints.hitting.acceleration_limits import AccelerationLimits
from hitjoints.hitting.braking import Brake, Braked
from hitjoints.hitting.compiled_step import CompiledStep, compiles
from hitjoints.hitting.desired import DesiredInertia, Weighting
from hitjoints.hitting.field import RATE, HittingField
from hitjoints.hitting.laws import LawMotion, LawName, law_named
from hitjoints.hitting.manipulability_posture import most_manipulable
from hitjoints.hitting.step import SLOWED, STABLE, Gains, Step
from hitjoints.hitting.step_length import wrong_step
from hitjoints.hitting.step_tape import Setting
from hitjoints.hitting.torque_limits import TorqueLimits
from hitjoints.programs.joint_velocity import reachable_speed
from hitjoints.programs.torque_rows import any_torque
from hitjoints.vectors import number, real

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

ReferenceName = Literal["constant", "optimised"]
BRAKING = 0.5  # share of the speed kept per step when no motion is certified
TOUCH = 1e-6  # rad beyond a limit that rounding or a sensor may report of an arm that stands at it
SHORTEST = 2e-5  # s, the shortest step: a quarter of what it costs


class Controller:
    """Makes an arm hit.

    Args:
        robot: the arm.
        hit: what is asked.
        q: (n,) rad, a configuration near the motion, such as its start: of equally good postures
            the nearest is taken.
        dt: s, time from one step to the next, 2e-5 to 0.05.
        inertia: kg, the desired inertia if `reference` is "constant"; by default that of the
            posture.
        reference: "optimised" (Eq. 13) or "constant".
        law: "qp" or "paper", see `hitting.laws`.
        weighting: W of Eq. 12, "identity" or "gradient".
        gains: of the null space.
        posture: (n,) rad, what the null space pulls to; by default the configuration of greatest
            manipulability at the object.
        speed_profile: of the field. "constant" keeps the speed that the flux needs also beside
            the line; Eq. 5 ("paper") slows down there, by 18 % at 2 mm with the default width.
        torque_limits: keep the robot's effort limits too, so that reaching a speed takes time, and
            keep able to stop before the position limits. With law="qp" only.
        acceleration_limits: the same for accelerations: True for the robot's, or rad/s^2, one
            number or (n,).
        compiled: take steps as one compiled call where its answer is proved right: ten times
            faster, after about half a second of compiling per robot and contact. Without llvmlite,
            with acceleration limits or law="paper", steps are taken the other way; with torque
            limits those in which the motors have less than is asked for.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: the object is out of the contact's reach.
    """

    def __init__(  # noqa: PLR0913
        self,
        robot: Robot,
        hit: Hit,
        q: ArrayLike,
        *,
        dt: float = 0.002,
        inertia: float | None = None,
        reference: ReferenceName = "optimised",
        law: LawName = "qp",
        weighting: Weighting = "identity",
        gains: Gains | None = None,
        posture: ArrayLike | None = None,
        speed_profile: Literal["paper", "constant"] = "constant",
        torque_limits: bool = False,
        acceleration_limits: bool | ArrayLike = False,
        compiled: bool = True,
    ) -> None:
        words = f"a step of {SHORTEST:g} s to {1 / RATE:g} s"
        dt = number(dt, "dt", words, lambda value: SHORTEST <= value <= 1.0 / RATE)
        if reference not in ("constant", "optimised"):
            raise UnknownNameError("reference", reference, ("constant", "optimised"))
        if not ((robot.velocity_lower <= 0) & (robot.velocity_upper >= 0)).all():
            raise InputError("robot", robot.name, "its velocity limits must allow standing still")
        limited = acceleration_limits is not False
        if law != "qp" and (torque_limits or limited):
            raise InputError("law", law, "torque and acceleration limits take the law 'qp'")
        self.robot, self.hit, self.dt = robot, hit, float(dt)
        self.point = ContactPoint(robot, hit.chosen_contact)
        self.contact = self.point.contact
        self.position, self.direction = hit.position, hit.direction
        self.gains = Gains() if gains is None else gains
        if posture is None:
            posture = most_manipulable(robot, self.contact, self.position, q)
        self.posture = robot.within_limits(posture, "posture")
        self._field = HittingField(self.position, self.direction, speed_profile=speed_profile)
        self._law = law_named(law, robot.n)
        told = None if acceleration_limits is True else acceleration_limits
        self.accelerations = AccelerationLimits(robot, self.dt, told) if limited else None
        self.torques = TorqueLimits(robot, self.dt, self.accelerations) if torque_limits else None
        self._brake = None if self.torques is None else Brake(robot, self.torques)
        self._desired = DesiredInertia(self.point, self.direction, self.dt, weighting)
        self._constant: float | None = None
        if reference == "constant":
            seen = self.point.inertia(self.posture, self.direction) if inertia is None else inertia
            self._constant = float(seen)
        self._lower, self._upper = robot.velocity_lower, robot.velocity_upper
        self._low, self._high, self._shape = robot.lower, robot.upper, (robot.n,)
        self._previous = np.zeros(robot.n)
        self._compiled: CompiledStep | None = None
        if compiled and law == "qp" and not limited and compiles():
            self._compiled = CompiledStep(
                robot,
                self.contact,
                Setting(
                    tuple(self.position),
                    tuple(self.direction),
                    hit.mass,
                    hit.desired_flux,
                    self.dt,
                    speed_profile == "constant",
                    weighting == "gradient",
                    *self.gains,
                    self._constant is not None,
                    self._constant or 0.0,
                    tuple(self.posture),
                ),
            )
        self.last: Step | None = None

    @property
    def arrived(self) -> bool:
        """The last step began at the object or beyond it."""
        return self.last is not None and self.ahead(self.last.position) <= 0

    def ahead(self, position: Array) -> float:
        """Return how far (m) a position (3,) is before the plane through the object."""
        return float(self.direction @ (self.position - position))

    def check_step(self, q: ArrayLike) -> None:
        """Refuse a dt in which the contact would cross the width of the field, or hardly move.

        Raises:
            InputError: the hit needs such a speed at q (n,) rad, or more than `MOST_STEPS` steps.
            InfeasibleError: the contact cannot move along the direction there.
        """
        q = self.robot.within_limits(q)
        state = self.point.observe(q, self.direction)
        reach = reachable_speed(self.direction @ state.J, self._lower, self._upper)
        speed = min(self.hit.speed(state.inertia), reach)
        wrong = wrong_step(speed, self.ahead(state.position), self.dt)
        if wrong:
            raise InputError("dt", self.dt, wrong)

    def bounds(self, q: Array) -> tuple[Array, Array]:
        """Return the joint velocities (n,), (n,) rad/s that keep all limits for one step."""
        return (
            np.maximum(self._lower, (self._low - q) / self.dt),
            np.minimum(self._upper, (self._high - q) / self.dt),
        )

    def step(self, q: ArrayLike, qd: ArrayLike | None = None) -> Array:
        """Return the joint velocity (n,) rad/s for the next dt; `last` tells more.

        It is within the velocity limits to the last bit, and q + qd dt is within the position
        limits up to rounding.

        Args:
            q: (n,) rad, where the arm is.
            qd: (n,) rad/s, how it moves, which only torque and acceleration limits need to know;
                by default as the last step asked, at first not at all.

        Raises:
            InputError: q is outside the position limits by more than 1e-6 rad, or not finite.
            InfeasibleError: the contact cannot move along the direction in this configuration.
        """
        if qd is None and self._take(q):
            return self._previous
        given, q = q, real(q, "q", f"{self._shape[0]} joint positions in rad")
        if q.shape != self._shape or not ((q >= self._low) & (q <= self._high)).all():
            q = self._touching(q)
        if qd is None and q is not given and self._take(q):
            return self._previous
        lower, upper = self.bounds(q)
        now = self._previous if qd is None else self._velocity(qd)
        impulses, kept = None, True
        if self.torques is not None:
            impulses = self.torques.impulses(q, now)
            lower, upper = self.torques.bounds(q, now, impulses, lower, upper)
            if self._compiled is not None:
                step = self._compiled.within_torques(q, lower, upper, impulses)
                if step is not None and self._can_stop(q, step.qd):
                    self.last, self._previous = step, step.qd
                    return step.qd
        state = self.point.observe(q, self.direction)
        if self.accelerations is not None:
            lower, upper = self.accelerations.stopping(q, lower, upper)
        pull = self.direction @ state.J
        # What the next step reaches is no measure of what the field may ask for.
        wanted, reach = self.hit.speed(state.inertia), reachable_speed(pull, lower, upper)
        if self.accelerations is not None:
            lower, upper, kept = self.accelerations.near(now, lower, upper)
            impulses = any_torque(q.size) if impulses is None else impulses
        out_of_reach = wanted > reach
        speed = reach if out_of_reach else wanted
        f = self._field(state.position, speed)
        desired = self._constant
        if desired is None:
            desired = self._desired(q, state, f, pull, speed, out_of_reach, lower, upper, impulses)
        motion = self._law(state.J, f, self._wish(q, state, desired), lower, upper, impulses)
        braked, safe = motion is None or not self._can_stop(q, motion.qd), kept
        if motion is None or braked:
            slower, stops = self.slower(q, now)
            motion, safe = LawMotion(slower, 0.0), kept and stops
        self._previous = motion.qd
        along = float(pull @ motion.qd)
        self.last = Step(
            motion.qd,
            state.position,
            state.inertia,
            desired,
            along,
            self.hit.flux_of(state.inertia, along),
            motion.scaling,
            out_of_reach or motion.scaling < SLOWED,
            braked,
            not safe,
        )
        return motion.qd

    def _take(self, q: ArrayLike) -> bool:
        """Take the step as one compiled call, and tell whether that went well."""
        taken = None if self._compiled is None or self.torques is not None else self._compiled(q)
        if taken is None:
            return False
        self.last, self._previous = taken, taken.qd
        return True

    def slower(self, q: Array, qd: Array, share: float = BRAKING) -> Braked:
        """Return the joint velocity (n,) rad/s of a step that slows the arm down.

        Args:
            q: (n,) rad.
            qd: (n,) rad/s, of the step before.
            share: of qd that is left, or less where limits demand it.
        """
        if self._brake is not None:
            return self._brake.slower(q, qd, share)
        (lower, upper), kept = self.bounds(q), True
        if self.accelerations is not None:
            stopping = self.accelerations.stopping(q, lower, upper)
            lower, upper, kept = self.accelerations.near(qd, *stopping)
        return Braked(np.minimum(np.maximum(share * qd, lower), upper), kept)

    def follow(self, q: Array, qd: Array) -> Array:
        """Return the configuration (n,) rad after a step at qd (n,) rad/s from q (n,) rad."""
        return np.clip(q + self.dt * qd, self._low, self._high)

    def _can_stop(self, q: Array, qd: Array) -> bool:
        return self.torques is None or self.torques.can_stop(self.follow(q, qd), qd)

    def _velocity(self, qd: ArrayLike) -> Array:
        array = real(qd, "qd", f"{self._shape[0]} finite joint velocities")
        if array.shape != self._shape or not np.isfinite(array).all():
            raise InputError("qd", array.tolist(), f"{self._shape[0]} finite joint velocities")
        return array

    def _touching(self, q: Array) -> Array:
        """Return q on the limits it exceeds by no more than `TOUCH`, and refuse any other."""
        near = np.clip(q, self._low, self._high) if q.shape == self._shape else q
        if q.shape == self._shape and np.abs(q - near).max() <= TOUCH:
            return near
        return self.robot.within_limits(q)

    def _wish(self, q: Array, state: State, desired: float) -> Array:
        """Return the joint velocity (n,) that the null space term of Eq. 7 asks for."""
        gradient = state.gradient
        most = STABLE / (self.dt * (float(gradient @ gradient) + 1e-12))
        gain = min(self.gains.inertia, most) * (state.inertia - desired)
        return np.asarray(self.gains.posture * (self.posture - q) - gain * gradient)
