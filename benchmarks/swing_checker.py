"""A judge of swings that shares nothing with what makes them.

Everything is taken from the positions, 0.1 ms apart: velocities, accelerations and jerks by
differences, torques from mass matrix and bias, the contact by forward kinematics, distances from
the arm's shapes, pair by pair.
"""

from __future__ import annotations

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
    robot, hit = swing.robot, swing.hit
    count = int(np.floor(swing.motion.duration / STEP))
    q = swing.motion.at(STEP * np.arange(count + 1)).q
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
    if np.abs(differences["velocity"][[0, -1]]).max() > 1e-6:
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
    J = np.zeros((6, robot.n))
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


def _clearance(swing: Swing, q: Array, at: int, size: Array) -> float:
    """Return the least distance: to itself, and to the object until the impact."""
    robot, hit, contact = swing.robot, swing.hit, swing.hit.chosen_contact
    shapes = pin.GeometryModel(robot.collision_model)
    for shape in shapes.geometryObjects:
        if hasattr(shape.geometry, "buildConvexHull"):
            shape.geometry.buildConvexHull(True, "Qt")
            shape.geometry = shape.geometry.convex
    links = [int(shape.parentJoint) for shape in shapes.geometryObjects]
    geometry, data = pin.GeometryData(shapes), robot.model.createData()
    carriers = {contact.joint} if any(contact.offset) else {contact.joint, contact.joint - 1}
    pairs = [
        (i, j)
        for i in range(len(links))
        for j in range(i)
        if abs(links[i] - links[j]) > 1 and (i, j) in _movable(robot, shapes, links)
    ]

    def place(row: Array) -> None:
        pin.updateGeometryPlacements(robot.model, data, shapes, geometry, row)

    def between(i: int, solid: Any, where: Any) -> float:
        here = geometry.oMg[i]
        at_i = coal.Transform3s(here.rotation, here.translation)
        return float(
            coal.distance(shapes.geometryObjects[i].geometry, at_i, solid, where,
                          coal.DistanceRequest(), coal.DistanceResult())
        )  # fmt: skip

    place(q[at])
    h = hit.direction
    contact_at = data.oMi[contact.joint].act(np.array(contact.offset))
    ball, mine = coal.Sphere(1e-5), [i for i, k in enumerate(links) if k in carriers]
    # The surface ahead of the contact: the farthest point on the line that touches a carrier.
    ahead = 0.6
    while ahead > 0:
        where = coal.Transform3s(np.eye(3), contact_at + ahead * h)
        gap = min(between(i, ball, where) for i in mine) if mine else np.inf
        if gap <= 1e-5:
            break
        ahead -= gap
    across = np.cross([0.0, 0.0, 1.0], h)
    across = across / np.linalg.norm(across) if np.linalg.norm(across) > 1e-9 else np.eye(3)[1]
    axes = np.column_stack((h, across, np.cross(h, across)))
    box = coal.Box(*size)
    placed = coal.Transform3s(axes, contact_at + (max(ahead, 0.0) + size[0] / 2) * h)

    def distance(i: int) -> float:
        place(q[i])
        found = [
            coal.distance(
                shapes.geometryObjects[a].geometry,
                coal.Transform3s(geometry.oMg[a].rotation, geometry.oMg[a].translation),
                shapes.geometryObjects[b].geometry,
                coal.Transform3s(geometry.oMg[b].rotation, geometry.oMg[b].translation),
                coal.DistanceRequest(),
                coal.DistanceResult(),
            )
            for a, b in pairs
        ]
        if i <= at:
            point = data.oMi[contact.joint].act(np.array(contact.offset))
            early = (hit.position - point) @ h > EARLY or i < last_way
            found += [between(a, box, placed) for a in range(len(links)) if early or a not in mine]
        return min(found, default=np.inf)

    # On the way there nothing may touch the box, wherever the contact is.
    last_way = round(
        sum(piece.duration for piece in swing.motion.pieces[:-2]) / STEP
    )
    coarse = list(range(0, len(q), 10))
    seen = {i: distance(i) for i in coarse}
    for i in coarse:
        if seen[i] < NEAR_BY:
            for j in range(max(i - 9, 0), min(i + 10, len(q))):
                if j not in seen:
                    seen[j] = distance(j)
    return min(seen.values())


_MOVABLE: dict[str, set[tuple[int, int]]] = {}


def _movable(robot: Any, shapes: Any, links: list[int]) -> set[tuple[int, int]]:
    """Return the pairs of shapes whose links get more than 15 cm apart."""
    if robot.digest not in _MOVABLE:
        geometry, data = pin.GeometryData(shapes), robot.model.createData()
        farthest: dict[tuple[int, int], float] = {}
        rng = np.random.default_rng(0)
        every = [(i, j) for i in range(len(links)) for j in range(i)]
        for q in rng.uniform(*robot.finite_limits, (300, robot.n)):
            pin.updateGeometryPlacements(robot.model, data, shapes, geometry, q)
            now: dict[tuple[int, int], float] = {}
            for i, j in every:
                where = geometry.oMg[i], geometry.oMg[j]
                gap = coal.distance(
                    shapes.geometryObjects[i].geometry,
                    coal.Transform3s(where[0].rotation, where[0].translation),
                    shapes.geometryObjects[j].geometry,
                    coal.Transform3s(where[1].rotation, where[1].translation),
                    coal.DistanceRequest(),
                    coal.DistanceResult(),
                )
                key = (links[i], links[j])
                now[key] = min(now.get(key, np.inf), gap)
            for key, gap in now.items():
                farthest[key] = max(farthest.get(key, -np.inf), gap)
        _MOVABLE[robot.digest] = {
            (i, j) for i, j in every if farthest[links[i], links[j]] >= BUILT_CLOSE
        }
    return _MOVABLE[robot.digest]
