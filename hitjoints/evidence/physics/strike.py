"""Arm and box from the first touch until they part, in the physics engine."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.errors import SolverError
from hitjoints.evidence.physics.engine_scene import build_scene
from hitjoints.evidence.physics.first_touch import ImpactState
from hitjoints.impact import spring_arm
from hitjoints.model.engine import engine

if TYPE_CHECKING:
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

    Reference = Callable[[float], Array]

TOGETHER = 3.0
"""Contact times after which an impact is over, though the arm may still push: plastic ones end so.
On elastic joints a light link may swing back and push on: there it is the closed form's count."""


@dataclass(frozen=True, eq=False)
class Strike:
    """What the engine makes of an impact.

    Attributes:
        object_speed: m/s, of the box's centre along the hitting direction when they part, or when
            the impact is over, though they stay together.
        rebound: m/s, change of the contact point's speed along it, negative.
        inertia: kg, by the balance of momentum: mass object_speed / -rebound.
        restitution: speed of parting of the two contact points along the face's normal, as a share
            of that of meeting.
        contact_time: s, from the first touch until then.
        contacts: how often they touch until the arm rests, apart by a contact's time at least.
        velocity: (3,) m/s, of the box's centre at the parting.
        spin: rad/s, of the box about the vertical, at the parting.
        box: the box's position and quaternion (7,), and its velocity (6,), at the end.
        rows: name -> array along time: `time` (s), `robot_speed`, `object_speed` (m/s), `force`
            (N), `q` (T, n), `box_position` (T, 3) m, `box_quaternion` (T, 4).
    """

    object_speed: float
    rebound: float
    inertia: float
    restitution: float
    contact_time: float
    contacts: int
    velocity: Array
    spin: float
    box: tuple[Array, Array] = field(repr=False)
    rows: dict[str, Array] = field(repr=False)


def strike(
    robot: Robot,
    impact: ImpactState,
    setting: EngineSetting,
    reference: Reference,
    follow: float = 0.0,
) -> Strike:
    """Let the arm hit the box, and follow both until they part.

    Args:
        robot: the arm.
        impact: the state at the first touch.
        setting: how it is made.
        reference: joint velocities (n,) rad/s that the servos follow, by the time (s) since.
        follow: s, until when both are followed at least; the speeds are those of the first parting.

    Raises:
        SolverError: the arm does not touch the box, or the engine loses one of them.
    """
    bout = _Bout(robot, impact, setting, reference)
    meeting = bout.closing
    while bout.now.force == 0:
        if bout.now.time > setting.contact_time:
            raise SolverError("the arm does not touch the box in the engine")
        bout.step()
    touch, approach = bout.now.time, bout.rows[0].robot_speed
    longest = spring_arm.TOGETHER if setting.stiffness else TOGETHER
    over = touch + longest * setting.contact_time
    while bout.now.force > 0 and bout.now.time < over:
        bout.step()
    parting = bout.now
    restitution = -bout.closing / meeting
    box = bout.velocity_of(bout.box)
    while bout.now.time < follow:
        bout.step()
    rebound = parting.robot_speed - approach
    if not np.isfinite((parting.object_speed, rebound, restitution)).all() or rebound == 0:
        raise SolverError("the engine loses the arm or the box while they touch")
    return Strike(
        object_speed=parting.object_speed,
        rebound=rebound,
        inertia=impact.mass * parting.object_speed / -rebound,
        restitution=restitution,
        contact_time=parting.time - touch,
        contacts=bout.contacts,
        velocity=box[3:],
        spin=float(box[2]),
        box=bout.pose,
        rows={
            name: np.array([getattr(row, name) for row in bout.rows]) for name in StrikeRow._fields
        },
    )


class StrikeRow(NamedTuple):
    """A moment: s; m/s along the hitting direction; N; (n,) rad; (3,) m; (4,)."""

    time: float
    robot_speed: float
    object_speed: float
    force: float
    q: Array
    box_position: Array
    box_quaternion: Array


class _Bout:
    """A running simulation; what is read in a row belongs to one moment."""

    def __init__(
        self, robot: Robot, impact: ImpactState, setting: EngineSetting, reference: Reference
    ) -> None:
        self.mujoco = engine()
        kind = self.mujoco.mjtObj
        self.model, self.data = build_scene(robot, impact, setting)
        self.direction, self.n = impact.direction, robot.n
        self.normal = impact.box_axes(setting)[:, 0]
        self.reference = reference if setting.servo_gain > 0 else None
        self.point = kind.mjOBJ_SITE, self.model.site("contact").id
        self.face = kind.mjOBJ_SITE, self.model.site("face").id
        self.box = kind.mjOBJ_BODY, self.model.body("box").id
        self.shape = self.model.geom("contact").id
        self.contacts, self._touched, self._apart = 0, -math.inf, setting.contact_time
        self.rows: list[StrikeRow] = []
        self._evaluate()

    @property
    def now(self) -> StrikeRow:
        """The latest row."""
        return self.rows[-1]

    @property
    def pose(self) -> tuple[Array, Array]:
        """The box's position and quaternion (7,), and its velocity (6,)."""
        n = self.n
        return self.data.qpos[n : n + 7].copy(), self.data.qvel[n : n + 6].copy()

    def step(self) -> None:
        """Go on by one step of the engine."""
        self.mujoco.mj_implicit(self.model, self.data)
        self._evaluate()
        if self.now.force > 0:
            self.contacts += self.now.time - self._touched > self._apart
            self._touched = self.now.time

    @property
    def closing(self) -> float:
        """Speed at which the contact points come together along the face's first normal, m/s."""
        point, face = self.velocity_of(self.point), self.velocity_of(self.face)
        return float(self.normal @ (point - face)[3:])

    def velocity_of(self, thing: tuple[Any, int]) -> Array:
        """Return the velocity (6,) of a body or site, turning first, in the robot's base frame."""
        velocity = np.zeros(6)
        self.mujoco.mj_objectVelocity(self.model, self.data, *thing, velocity, 0)
        return velocity

    def speed_of(self, thing: tuple[Any, int]) -> float:
        """Return the speed of a body or site along the hitting direction."""
        return float(self.direction @ self.velocity_of(thing)[3:])

    def _evaluate(self) -> None:
        """Compute the forces of this moment, and add its row."""
        data = self.data
        if self.reference is not None:
            data.ctrl[:] = self.reference(data.time)
        self.mujoco.mj_forward(self.model, data)
        speeds = self.speed_of(self.point), self.speed_of(self.box)
        state = data.qpos.copy()
        parts = state[: self.n], state[self.n : self.n + 3], state[self.n + 3 : self.n + 7]
        self.rows.append(StrikeRow(data.time, *speeds, self._force(), *parts))

    def _force(self) -> float:
        """Return the force between arm and box along the contact's normal, N."""
        touching = np.flatnonzero((self.data.contact.geom == self.shape).any(axis=1))
        if not touching.size:
            return 0.0
        wrench = np.zeros(6)
        self.mujoco.mj_contactForce(self.model, self.data, touching[0], wrench)
        return float(wrench[0])
