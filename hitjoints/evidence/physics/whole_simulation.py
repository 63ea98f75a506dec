"""A swing from rest to rest by position servos, with its box on the table, in one simulation.

Far from the box the engine takes longer steps, near it those of a contact; what moves is handed on.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.constants import GRAVITY
from hitjoints.dynamics.kinematics import jacobian
from hitjoints.errors import InfeasibleError, InputError, SolverError
from hitjoints.evidence.physics.engine_scene import FIRMER, RADIUS, build_scene
from hitjoints.evidence.physics.first_touch import is_level
from hitjoints.evidence.physics.setting import EngineSetting
from hitjoints.evidence.physics.simulation import impact_of
from hitjoints.evidence.physics.slide import AT_REST, LONGEST, SETTLING, STEP, is_tipped
from hitjoints.evidence.physics.strike import TOGETHER
from hitjoints.evidence.physics.whole_hit import FirstTouch, WholeHit
from hitjoints.goals.box_rest import BoxRest, level_axes, predict_rest, rest_at
from hitjoints.goals.sliding import Support, slide_to_rest
from hitjoints.model.engine import engine
from hitjoints.swings.as_rollout import as_rollout

if TYPE_CHECKING:
    from hitjoints.swings.swing_record import Swing
    from hitjoints.types import Array

BANDWIDTH = 10.0
"""Hz, of the servos."""
CONTACT_TIME = 1e-3
"""s."""
NEAR = 2e-3
"""m, between arm and box, within which the engine takes the steps of a contact."""
REFERENCE = 1e-4
"""s, spacing of what the servos follow; between, it is continued by its velocity."""


def simulate_whole(
    swing: Swing,
    *,
    bandwidth: float = BANDWIDTH,
    contact_time: float = CONTACT_TIME,
    support: Support = "face",
    rotors: tuple[float, ...] = (),
    stiffness: tuple[float, ...] = (),
) -> WholeHit:
    """Follow a swing with position servos, hit the box, and let it slide, in one simulation.

    A joint's servo has the stiffness and the damping that make it, alone, a critically damped
    spring of the bandwidth; it follows position and velocity, is no stronger than the joint's
    effort limit, and knows nothing of the box. Gravity is compensated.

    Args:
        swing: with a level hit that says restitution, friction and size.
        bandwidth: Hz, of the servos.
        contact_time: s, of arm and box.
        support: what carries the box.
        rotors: (n,) kg m^2, of motors behind springs; none: rigid joints.
        stiffness: (n,) N m/rad, of those springs.

    Raises:
        InputError: the hit does not say what is needed, or is not level.
        InfeasibleError: the box would not simply slide, or the arm does not touch it.
        MissingExtraError: MuJoCo is not installed.
    """
    hit = swing.hit
    for name in ("restitution", "friction", "size"):
        if getattr(hit, name) is None:
            raise InputError(name, None, "where the box ends depends on it")
    if not is_level(hit.direction):
        expected = "a box on a level table is hit horizontally"
        raise InputError("direction", hit.direction.tolist(), expected)
    if not (math.isfinite(bandwidth) and bandwidth > 0):
        raise InputError("bandwidth", bandwidth, "finite and above 0 Hz")
    assert hit.size is not None
    setting = EngineSetting(
        hit.restitution or 0.0, tuple(hit.size.tolist()), hit.friction or 0.0, contact_time,
        yaw=hit.yaw, support=support, on_table=True, rotors=rotors, stiffness=stiffness,
    )  # fmt: skip
    meant = predict_rest(swing.robot, swing.q_hit, hit, swing.speed, support=support)
    return _Run(swing, setting, bandwidth).whole(meant)


class _Run:
    """A running simulation: the arm's joints, then the box's free joint, then motors if any."""

    def __init__(self, swing: Swing, setting: EngineSetting, bandwidth: float) -> None:
        self.mujoco, self.swing, self.setting = engine(), swing, setting
        self.impact, robot = impact_of(as_rollout(swing)), swing.robot
        self.n, self.effort = robot.n, np.where(robot.effort > 0, robot.effort, np.inf)
        self.stages = [
            build_scene(robot, self.impact, setting, steps) for steps in ((STEP, SETTLING), None)
        ]
        self.sags = GRAVITY * np.array([SETTLING, setting.contact_time / FIRMER]) ** 2
        self.stage = 0
        names = list(robot.joint_names)
        for i, stiffness in enumerate(setting.stiffness):
            if stiffness and setting.rotors[i] > 0:
                names[i] = f"motor_{i + 1}"
        joints = [self.stages[0][0].joint(name) for name in names]
        self.at = np.array([joint.qposadr[0] for joint in joints])
        self.of = np.array([joint.dofadr[0] for joint in joints])
        told = swing.motion.at(REFERENCE * np.arange(swing.motion.duration / REFERENCE + 1))
        self.q, self.qd = told.q, told.qd
        bare = pin.crba(robot.model, robot.model.createData(), swing.q_hit)
        inertia = np.diag(bare) + (setting.rotors or 0.0)
        rate = 2 * math.pi * bandwidth
        self.gains = inertia * rate**2, 2 * inertia * rate
        self.shape = self.stages[0][0].geom("contact").id
        self.turned, self.heading, self.error, self.waits = 0.0, 0.0, 0.0, True
        self.flags = int(self.stages[0][0].opt.disableflags)
        self.no_contacts = int(self.mujoco.mjtDisableBit.mjDSBL_CONTACT)
        self._begin()

    @property
    def model(self) -> Any:
        """Of the present stage."""
        return self.stages[self.stage][0]

    @property
    def data(self) -> Any:
        """Of the present stage."""
        return self.stages[self.stage][1]

    def _begin(self) -> None:
        """Put the arm where the swing starts, at rest."""
        data = self.data
        data.qvel[:] = 0
        data.qpos[: self.n] = data.qpos[self.at] = self.q[0]
        data.qpos[self.n + 2] -= self.sags[0]
        self.start = data.qpos[self.n : self.n + 2].copy()
        self.mujoco.mj_forward(self.model, data)
        self.heading = _heading(data.qpos[self.n + 3 : self.n + 7])

    def whole(self, meant: BoxRest) -> WholeHit:
        """Run all of it.

        Args:
            meant: where the box is to rest.

        Raises:
            InfeasibleError: the arm does not touch the box.
            SolverError: the box does not come to rest.
        """
        ends = float(self.swing.motion.duration)
        while (place := self._pushed_at()) is None:
            if self.data.time > ends:
                raise InfeasibleError("the arm passes by the box without touching it")
            self._step()
        touch, error, self.waits = self._touch(place), self.error, False
        over = touch.time + TOGETHER * self.setting.contact_time
        while self._pushed_at() is not None and self.data.time < over:
            self._step()
        left = last = self._left()
        contacts, pushes, tipped = 1, False, False
        while self.data.time < ends or np.abs(self._box_speed()).max() > AT_REST:
            if self.data.time > ends + LONGEST:
                raise SolverError(f"the box does not come to rest within {LONGEST:g} s")
            self._step()
            again = self._pushed_at() is not None
            contacts += again and not pushes
            if pushes and not again:
                last = self._left()
            pushes = again
            tipped = is_tipped(self.data.body("box").xmat, self.setting.size)
            if tipped:
                break
        rest = self._rest_at(self._way(), self.turned, left, tipped)
        by_touch = predict_rest(
            self.swing.robot, touch.q, self.swing.hit, touch.speed,
            off_centre=touch.off_centre, height=touch.height, support=self.setting.support,
        )  # fmt: skip
        return WholeHit(
            self.swing, self.setting, touch, meant, by_touch, left, last, rest, contacts, error
        )

    def _step(self) -> None:
        """Go on by one step, of the stage that the gap between arm and box asks for."""
        self._choose(int(self._gap() < NEAR))
        data, waits = self.data, self.waits and self.stage == 0
        standing = data.qpos[self.n : self.n + 7].copy()
        self.stages[0][0].opt.timestep = REFERENCE if waits else STEP
        self.stages[0][0].opt.disableflags = self.flags | (self.no_contacts if waits else 0)
        row = min(int(data.time / REFERENCE), len(self.q) - 1)
        ahead = self.q[row] + self.qd[row] * (data.time - row * REFERENCE) - data.qpos[self.at]
        stiffness, damping = self.gains
        torque = stiffness * ahead + damping * (self.qd[row] - data.qvel[self.of])
        data.qfrc_applied[self.of] = np.clip(torque, -self.effort, self.effort)
        self.error = max(self.error, float(np.abs(ahead).max()))
        self.mujoco.mj_step(self.model, data)
        if waits:  # the box rests as it stands, and costs nothing
            data.qpos[self.n : self.n + 7], data.qvel[self.n : self.n + 6] = standing, 0.0
        if not np.isfinite(data.qvel).all():
            raise SolverError("the engine loses the arm or the box")
        heading = _heading(data.qpos[self.n + 3 : self.n + 7])
        self.turned += math.remainder(heading - self.heading, 2 * math.pi)
        self.heading = heading

    def _choose(self, stage: int) -> None:
        """Hand what moves on to another stage, the box on springs that bear its weight there."""
        if stage == self.stage:
            return
        before, after = self.data, self.stages[stage][1]
        after.time = before.time
        after.qpos[:], after.qvel[:] = before.qpos, before.qvel
        after.qpos[self.n + 2] += self.sags[self.stage] - self.sags[stage]
        self.stage = stage
        self.mujoco.mj_forward(self.model, after)

    def _gap(self) -> float:
        """Return the distance of the arm's surface from the box, m."""
        data = self.data
        box = data.body("box")
        seen = box.xmat.reshape(3, 3).T @ (data.geom_xpos[self.shape] - box.xpos)
        outside = np.maximum(np.abs(seen) - np.array(self.setting.size) / 2, 0.0)
        return float(np.linalg.norm(outside)) - RADIUS

    def _pushed_at(self) -> Array | None:
        """Return where the arm pushes the box, (3,) m; None if it does not."""
        data = self.data
        touching = np.flatnonzero((data.contact.geom == self.shape).any(axis=1))
        wrench = np.zeros(6)
        for one in touching:
            self.mujoco.mj_contactForce(self.model, data, one, wrench)
            if wrench[0] > 0:
                return np.array(data.contact.pos[one])
        return None

    def _touch(self, place: Array) -> FirstTouch:
        data, robot, how = self.data, self.swing.robot, self.setting
        q, qd = data.qpos[: self.n].copy(), data.qvel[: self.n].copy()
        box = data.body("box")
        _, aside, height = box.xmat.reshape(3, 3).T @ (place - box.xpos)
        offset = aside * math.cos(how.yaw) - how.size[0] / 2 * math.sin(how.yaw)
        velocity = jacobian(robot, q, self.impact.contact) @ qd
        speed = float(self.impact.direction @ velocity)
        return FirstTouch(float(data.time), speed, q, qd, -float(offset), float(height))

    def _box_speed(self) -> Array:
        return np.asarray(self.data.qvel[self.n : self.n + 6])

    def _way(self) -> Array:
        return np.asarray(self.data.qpos[self.n : self.n + 2] - self.start)

    def _left(self) -> BoxRest:
        """Return where the box rests by the law, from what it does now."""
        hit, how = self.swing.hit, self.setting
        velocity, spin = self._box_speed()[:2], float(self._box_speed()[5])
        axes = level_axes(hit)
        slid = slide_to_rest(
            [velocity @ axes], spin, how.size, how.friction, yaw=how.yaw + self.turned,
            support=how.support,
        )  # fmt: skip
        way = self._way() + axes @ slid.displacement[0]
        speed = float(np.hypot(*velocity))
        return rest_at(
            hit, way, yaw=self.turned + float(slid.yaw[0]), speed=speed, spin=spin, tipped=False
        )

    def _rest_at(self, way: Array, yaw: float, left: BoxRest, tipped: bool) -> BoxRest:
        speed, spin = left.speed, left.spin
        return rest_at(self.swing.hit, way, yaw=yaw, speed=speed, spin=spin, tipped=tipped)


def _heading(quaternion: Array) -> float:
    w, x, y, z = quaternion
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
