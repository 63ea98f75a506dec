"""A judge of swings that shares nothing with what makes them.

Everything is taken from the positions, 0.1 ms apart: velocities, accelerations and jerks by
differences, torques from mass matrix and bias, the contact by forward kinematics, distances from
the arm's shapes, pair by pair.
"""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import coal
import numpy as np
import pinocchio as pin

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.swings.swing_record import Swing

    Array = NDArray[np.float64]

STEP = 1e-4
ROUNDING = {"velocity": 1e-9, "acceleration": 1e-6, "jerk": 1e-4}
"""Share of a limit that differences of rounded positions may be beyond it."""
NEAR_BY = 0.02  # m: nearer than that, distances are looked at every 0.1 ms, else every ms
EARLY = 0.05  # m before the object from where on the hitting links may be near it
BUILT_CLOSE = 0.15  # m: links that are never farther apart are built that close


def judge(swing: Swing, size: Array, margin: float) -> dict[str, Any]:
    """Return what is wrong with a swing, and how well it strikes.

    Args:
        swing: to be judged.
        size: (3,) m, of the object. margin: m, asked for.
    """
    robot, _hit = swing.robot, swing.hit
    count = int(np.floor(swing.motion.duration / STEP))
    q = swing.motion.at(np.asarray(STEP * np.arange(count + 1.0))).q
    wrong: list[str] = []
    if ((q < robot.lower) | (q > robot.upper)).any():
        wrong.append("position")
    differences = {"velocity": np.diff(q, axis=0) / STEP}
    differences["acceleration"] = np.diff(differences["velocity"], axis=0) / STEP
    differences["jerk"] = np.diff(differences["acceleration"], axis=0) / STEP
    limits = {"velocity": robot.velocity_upper, "acceleration": swing.limits.acceleration}
    if swing.limits.jerk_known:
        limits["jerk"] = swing.limits.jerk
    for name, limit in limits.items():
        if (np.abs(differences[name]) > limit * (1 + ROUNDING[name]) + 1e-9).any():
            wrong.append(name)
    # From rest with the greatest jerk j the mean velocity over the first step is j dt^2 / 6.
    if (
        np.abs(differences["velocity"][[0, -1]]).max()
        > 1.01 * swing.limits.jerk.max() * STEP**2 / 6
    ):
        wrong.append("not at rest")
    if np.abs(q[0] - swing.q0).max() > 0:
        wrong.append("start")
    if _torque_ratio(swing, q, differences) > 1 + 1e-3:
        wrong.append("torque")
    at = round(swing.impact_time / STEP)
    strike = _strike(swing, q, at)
    least = _clearance(swing, q, at, size)
    if least < margin - 1e-6:
        wrong.append("clearance")
    wanted = swing.hit.flux
    bounds = {"miss": 1e-4, "angle": 1.0, "angle_before": 3.0, "sideways": 5e-3}
    wrong += [name for name, most in bounds.items() if strike[name] > most]
    if wanted is not None and abs(strike["flux"] / wanted - 1) > 5e-3:
        wrong.append("flux")
    return {"wrong": wrong, "clearance": least, **strike}


def _torque_ratio(swing: Swing, q: Array, differences: dict[str, Array]) -> float:
    """Return the greatest torque in units of its limit, every half millisecond."""
    robot, most = swing.robot, 0.0
    rotors = np.zeros(robot.n) if robot.rotor_inertia is None else robot.rotor_inertia
    data = robot.model.createData()
    told = np.isfinite(robot.effort) & (robot.effort > 0)
    velocity, acceleration = differences["velocity"], differences["acceleration"]
    for i in range(1, len(q) - 1, 5):
        qd = 0.5 * (velocity[i - 1] + velocity[i])
        M = pin.crba(robot.model, data, q[i])
        torque = M @ acceleration[i - 1] + rotors * acceleration[i - 1]
        torque += pin.nonLinearEffects(robot.model, data, q[i], qd)
        most = max(most, float((np.abs(torque[told]) / robot.effort[told]).max(initial=0.0)))
    return most


def _points(swing: Swing, q: Array) -> Array:
    robot, contact = swing.robot, swing.hit.chosen_contact
    data, offset = robot.model.createData(), np.array(contact.offset)
    found = []
    for row in q:
        pin.forwardKinematics(robot.model, data, row)
        found.append(data.oMi[contact.joint].act(offset))
    return np.array(found)


def _strike(swing: Swing, q: Array, at: int) -> dict[str, float]:
    """Return miss, flux, angles and sideways motion of the contact."""
    robot, hit, h = swing.robot, swing.hit, swing.hit.direction
    first = max(at - int(0.6 / STEP), 0)
    path = _points(swing, q[first : at + 3]) - hit.position
    k = at - first
    speeds = (path[2:] - path[:-2]) / (2 * STEP)
    velocity = speeds[k - 1]
    ahead = -path[: k + 1] @ h
    aside = np.linalg.norm(path[: k + 1] + ahead[:, None] * h, axis=1)
    last = int(np.flatnonzero(ahead > 0.03)[-1]) if (ahead > 0.03).any() else 0
    before = int(np.argmin(np.abs(ahead[last:] - 0.005))) + last
    data = robot.model.createData()
    contact = swing.hit.chosen_contact
    pin.computeJointJacobians(robot.model, data, q[at])
    J = pin.getFrameJacobian(
        robot.model, data, contact.joint, pin.SE3(np.eye(3), np.array(contact.offset)),
        pin.LOCAL_WORLD_ALIGNED,
    )[:3]  # fmt: skip
    g = J.T @ h
    inertia = 1.0 / float(g @ np.linalg.solve(pin.crba(robot.model, data, q[at]), g))

    def angle(v: Array) -> float:
        return float(np.degrees(np.arctan2(np.linalg.norm(v - (v @ h) * h), v @ h)))

    return {
        "miss": float(np.linalg.norm(path[k])),
        "flux": inertia / (inertia + hit.mass) * float(velocity @ h),
        "angle": angle(velocity),
        "angle_before": angle(speeds[max(before - 1, 0)]),
        "sideways": float(aside[last:].max()),
    }


class _Shapes:
    """An arm's convex shapes, and the pairs of them that can get more than 15 cm apart."""

    def __init__(self, robot: Any) -> None:
        self.model, self.data = robot.model, robot.model.createData()
        self.shapes = pin.GeometryModel(robot.collision_model)
        for shape in self.shapes.geometryObjects:
            if hasattr(shape.geometry, "buildConvexHull"):
                shape.geometry.buildConvexHull(True, "Qt")
                shape.geometry = shape.geometry.convex
        self.links = [int(shape.parentJoint) for shape in self.shapes.geometryObjects]
        count = len(self.links)
        pairs = [(i, j) for i in range(count) for j in range(i)]
        pairs = [(i, j) for i, j in pairs if abs(self.links[i] - self.links[j]) > 1]
        self._take(pairs)
        farthest: dict[tuple[int, int], float] = {}
        rng = np.random.default_rng(0)
        low, high = robot.finite_limits
        for q in rng.uniform(low, high, (300, robot.n)):
            now: dict[tuple[int, int], float] = {}
            for (i, j), gap in zip(pairs, self.own(q), strict=True):
                key = (self.links[i], self.links[j])
                now[key] = min(now.get(key, np.inf), gap)
            for key, gap in now.items():
                farthest[key] = max(farthest.get(key, -np.inf), gap)
        apart = [(i, j) for i, j in pairs if farthest[self.links[i], self.links[j]] >= BUILT_CLOSE]
        self._take(apart)

    def _take(self, pairs: list[tuple[int, int]]) -> None:
        self.shapes.removeAllCollisionPairs()
        for pair in pairs:
            self.shapes.addCollisionPair(pin.CollisionPair(*pair))
        self.geometry = pin.GeometryData(self.shapes)

    def own(self, q: Array) -> list[float]:
        """Return the distances of the pairs at q, and leave the arm there."""
        pin.computeDistances(self.model, self.data, self.shapes, self.geometry, q)
        return [result.min_distance for result in self.geometry.distanceResults]

    def off(self, i: int, solid: Any, where: Any) -> float:
        """Return the distance of shape i, where it is, from a solid."""
        here = self.geometry.oMg[i]
        at = coal.Transform3s(here.rotation, here.translation)
        mine = self.shapes.geometryObjects[i].geometry
        request, result = coal.DistanceRequest(), coal.DistanceResult()
        return float(coal.distance(mine, at, solid, where, request, result))


@lru_cache(maxsize=8)
def _shapes_of(robot: Any) -> _Shapes:
    return _Shapes(robot)


def _clearance(swing: Swing, q: Array, at: int, size: Array) -> float:
    """Return the least distance: of the arm from itself, and from the object until the impact."""
    arm, hit, contact = _shapes_of(swing.robot), swing.hit, swing.hit.chosen_contact
    carriers = {contact.joint} if any(contact.offset) else {contact.joint, contact.joint - 1}
    mine = [i for i, k in enumerate(arm.links) if k in carriers]
    arm.own(q[at])
    h = hit.direction
    contact_at = arm.data.oMi[contact.joint].act(np.array(contact.offset))
    # The surface ahead of the contact: the farthest point on the line that touches a carrier.
    ball, ahead = coal.Sphere(1e-5), 0.6
    while ahead > 0 and mine:
        where = coal.Transform3s(np.eye(3), contact_at + ahead * h)
        gap = min(arm.off(i, ball, where) for i in mine)
        if gap <= 1e-5:
            break
        ahead -= gap
    across = np.cross([0.0, 0.0, 1.0], h)
    across = across / np.linalg.norm(across) if np.linalg.norm(across) > 1e-9 else np.eye(3)[1]
    axes = np.column_stack((h, across, np.cross(h, across)))
    box = coal.Box(*size)
    placed = coal.Transform3s(axes, contact_at + (max(ahead, 0.0) + size[0] / 2) * h)
    # On the way there nothing may touch the box, wherever the contact is.
    wind_up = round(sum(piece.duration for piece in swing.motion.pieces[:-2]) / STEP)

    def distance(i: int) -> float:
        found = arm.own(q[i])
        if i <= at:
            point = arm.data.oMi[contact.joint].act(np.array(contact.offset))
            early = (hit.position - point) @ h > EARLY or i < wind_up
            shapes = [a for a in range(len(arm.links)) if early or a not in mine]
            found += [arm.off(a, box, placed) for a in shapes]
        return min(found, default=np.inf)

    seen = {i: distance(i) for i in range(0, len(q), 10)}
    for i in sorted(seen):
        if seen[i] < NEAR_BY:
            more = range(max(i - 9, 0), min(i + 10, len(q)))
            seen |= {j: distance(j) for j in more if j not in seen}
    return min(seen.values())
