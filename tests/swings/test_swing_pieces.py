"""The pieces of a swing, against differences, closed forms, an integrator and HiGHS."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import linprog

import hitjoints as hj
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.errors import InputError
from hitjoints.hitting.drive_limits import SHAPING, drive_limits
from hitjoints.hitting.velocity_box import velocity_box
from hitjoints.swings.clear_way import SHARP, Room
from hitjoints.swings.curves import (
    Motion,
    Standing,
    Stroke,
    line_between,
    slowing_down,
    winding_up,
)  # fmt: skip
from hitjoints.swings.hit_candidates import HitCandidates
from hitjoints.swings.hit_samples import draw, folded, measured, spread_out
from hitjoints.swings.impact_state import StateAtHit, impact_velocity, straightening
from hitjoints.swings.ramps import least_time, ramp_of
from hitjoints.swings.swing_task import SwingTask
from hitjoints.swings.wind_ups import WindUpFamilies

SIZE = np.array([0.1, 0.1, 0.1])
OBJECT, ALONG = np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0])


def kept(limits, joints):
    """Assert that velocities, accelerations and jerks are within limits."""
    assert (joints.qd <= limits.velocity_upper).all()
    assert (joints.qd >= limits.velocity_lower).all()
    assert (np.abs(joints.qdd) <= limits.acceleration).all()
    assert (np.abs(joints.qddd) <= limits.jerk).all()


def consistent(piece, samples=4001):
    """Assert that the derivatives are those of the positions, and return the joints."""
    times = np.linspace(0, piece.duration, samples)
    joints, step = piece.at(times), times[1]
    jerk = np.abs(joints.qddd).max() + 1e-9
    for values, rates, most in (
        (joints.q, joints.qd, step * jerk * step),
        (joints.qd, joints.qdd, step * jerk),
    ):
        middle = 0.5 * (rates[1:] + rates[:-1])
        assert np.abs(np.diff(values, axis=0) / step - middle).max() <= most + 1e-9
    return joints


def test_the_least_time_of_a_ramp_is_that_of_an_integrator():
    """Bang-bang jerk, cut where the acceleration is at its limit, reaches unit speed then."""
    for a, j in ((2.0, 3.0), (2.0, 30.0), (1.0, 1.0), (5.0, 2.0)):
        T = float(least_time(np.array([a]), np.array([j]))[0])
        build = min(a / j, T / 2)

        def jerk(t, build=build, T=T, j=j):
            return j if t < build else (-j if t > T - build else 0.0)

        found = solve_ivp(
            lambda t, y, jerk=jerk: (y[1], jerk(t)), (0, T), (0.0, 0.0), max_step=T / 2000
        )
        assert found.y[0, -1] == pytest.approx(1.0, abs=2e-3)
        assert found.y[1].max() <= a * (1 + 1e-3)


def test_ramps_keep_their_limits_whatever_time_they_are_given():
    rng = np.random.default_rng(1)
    a, j = rng.uniform(0.1, 20, 500), rng.uniform(0.1, 200, 500)
    ramp = ramp_of(least_time(a, j) * rng.uniform(0.5, 6, 500), a, j)
    assert (ramp.build > 0).all()
    assert (ramp.build <= ramp.time / 2 * (1 + 1e-12)).all()
    x = np.linspace(0, 1, 400)[:, None] * ramp.time
    up = ramp.up(x)
    assert (up.acceleration <= a * (1 + 1e-9)).all()
    assert (np.abs(up.jerk) <= j * (1 + 1e-9)).all()
    np.testing.assert_allclose(up.speed[-1], 1)
    np.testing.assert_allclose(up.way[-1], ramp.time / 2)
    np.testing.assert_allclose(ramp.down(ramp.time - x).speed, up.speed, atol=1e-12)


def test_from_any_velocity_of_the_box_there_is_a_way_from_rest_and_to_rest(arm):
    robot = arm("panda")
    limits, rng = drive_limits(robot), np.random.default_rng(2)
    coast = 0.02
    for i in range(200):
        q = rng.uniform(robot.lower, robot.upper)
        q = np.where(rng.random(7) < 0.2, robot.upper - 1e-6, q)
        low, high = velocity_box(limits, q, robot.lower, robot.upper, coast)
        assert (low <= 0).all()
        assert (high >= 0).all()
        v = low if i == 0 else high if i == 1 else rng.uniform(low, high)
        size = np.maximum(np.abs(v), 1e-12)
        behind, ahead = (np.where(v > 0, *ends) for ends in (
            (q - robot.lower, robot.upper - q), (robot.upper - q, q - robot.lower)
        ))  # fmt: skip
        ramp = ramp_of(np.zeros(7), limits.acceleration_used / size, limits.jerk_used / size)
        assert (size * ramp.time / 2 <= behind + 1e-12).all()
        assert (size * (coast + ramp.time / 2) <= ahead + 1e-12).all()
        joints = consistent(Stroke(q, v, np.zeros(7), ramp, coast, ramp), 1001)
        kept(limits, joints)
        assert (joints.q >= robot.lower - 1e-12).all()
        assert (joints.q <= robot.upper + 1e-12).all()


def test_a_curved_stroke_strikes_as_told():
    rng = np.random.default_rng(3)
    q, v, c = rng.normal(size=(3, 5))
    ramps = [ramp_of(T, np.full(5, 50.0), np.full(5, 5e3)) for T in rng.uniform(0.1, 0.5, (2, 5))]
    stroke = Stroke(q, v, c, ramps[0], 0.03, ramps[1])
    at = stroke.at(np.array([stroke.impact, stroke.impact + 0.02]))
    assert at.q[0].tobytes() == q.tobytes()
    np.testing.assert_allclose(at.qd[0], v, rtol=1e-14)
    np.testing.assert_allclose(at.qd[1], v + 0.02 * c)
    joints = consistent(stroke)
    assert not joints.qd[[0, -1]].any()
    assert not joints.qdd[-1].any()


def test_corners_show_what_a_ramp_too_short_for_samples_asks_for():
    """A joint that hardly moves but bends, and has no room to stop in: its ramp takes 0.1 ms."""
    v, c = np.array([1.0, 1e-3]), np.array([0.0, 5.0])
    wide = ramp_of(np.full(2, 0.2), np.full(2, 50.0), np.full(2, 5e3))
    short = ramp_of(np.array([0.2, 1e-4]), np.array([50.0, 1e6]), np.array([5e3, 1e12]))
    stroke = Stroke(np.zeros(2), v, c, wide, 0.02, short)
    seen = np.abs(stroke.at(stroke.corners).qdd).max()
    most = np.abs(stroke.at(np.linspace(0, stroke.duration, 400_001)).qdd).max()
    sampled = np.abs(stroke.at(np.arange(0.00025, stroke.duration, 5e-4)).qdd).max()
    assert seen == pytest.approx(most, rel=0.02)
    assert sampled < 0.5 * most


def test_lines_are_as_fast_as_one_limit_allows(arm):
    robot = arm("panda")
    limits, rng = drive_limits(robot), np.random.default_rng(4)
    for i in range(60):
        start, end = rng.uniform(robot.lower, robot.upper, (2, 7))
        if i % 3 == 0:
            end = start + 1e-3 * (end - start)
        line = line_between(start, end, limits)
        joints = consistent(line)
        kept(limits, joints)
        assert joints.q[0].tobytes() == start.tobytes()
        assert joints.q[-1].tobytes() == end.tobytes()
        used = [np.abs(joints.qd / limits.velocity_upper).max()]
        used += [np.abs(joints.qdd / limits.acceleration).max()]
        used += [np.abs(joints.qddd / limits.jerk).max()]
        assert max(used) > 0.999
        np.testing.assert_allclose(joints.qd[[0, -1]], 0, atol=1e-15)


def test_a_motion_is_its_pieces_in_turn(arm):
    robot = arm("iiwa14")
    limits, home = drive_limits(robot), robot.home
    there = home + 0.3
    pieces = [Standing(home, 0.1), line_between(home, there, limits), Standing(there, 0.2)]
    motion = Motion(pieces)
    times = np.random.default_rng(0).permutation(np.linspace(0, motion.duration, 300))
    joints = motion.at(times)
    order = np.argsort(times)
    assert (np.diff(joints.q[order], axis=0) >= 0).all()
    assert (joints.q[times < 0.1] == home).all()
    assert np.abs(joints.q[times > motion.duration - 0.19] - there).max() < 1e-12


def test_the_impact_velocity_is_the_fastest_or_the_least(arm):
    """Against HiGHS for the fastest, and against random feasible ones for the least norm."""
    robot = arm("iiwa14")
    limits, rng = drive_limits(robot), np.random.default_rng(5)
    for _ in range(40):
        q, h = rng.uniform(robot.lower, robot.upper), rng.standard_normal(3)
        h /= np.linalg.norm(h)
        J = jacobian(robot, q, 6)
        low, high = velocity_box(limits, q, robot.lower, robot.upper)
        across = np.linalg.svd(h[None])[2][1:]
        best = linprog(
            -h @ J, A_eq=across @ J, b_eq=[0, 0], bounds=list(zip(low, high, strict=True))
        )
        fastest = impact_velocity(J, h, low, high)
        if -best.fun < 1e-3:
            continue
        assert h @ J @ fastest == pytest.approx(-best.fun, rel=1e-6)
        speed = rng.uniform(0.2, 0.99) * -best.fun
        qd = impact_velocity(J, h, low, high, speed)
        np.testing.assert_allclose(J @ qd, speed * h, atol=1e-8)
        assert ((qd >= low) & (qd <= high)).all()
        width = np.maximum(np.maximum(high, -low), 1e-3)
        null = np.linalg.svd(J)[2][3:]
        for _ in range(50):
            other = qd + rng.normal(0, 0.1, len(null)) @ null
            if ((other >= low) & (other <= high)).all():
                assert np.linalg.norm(other / width) >= np.linalg.norm(qd / width) - 1e-6
        assert impact_velocity(J, h, low, high, 1.01 * -best.fun) is None


def test_the_straightened_curve_has_no_sideways_curvature(arm):
    robot, contact = arm("panda"), hj.Contact(6, (0.05, 0.02, 0.1))
    rng = np.random.default_rng(6)
    for _ in range(10):
        q = rng.uniform(robot.lower, robot.upper)
        J, h = jacobian(robot, q, contact), rng.standard_normal(3)
        h /= np.linalg.norm(h)
        qd = np.linalg.pinv(J) @ h
        c = straightening(robot, q, qd, contact, h, J, rng.uniform(0.5, 2.0, 7))
        e = 1e-4
        path = [position(robot, q + s * qd + s * s / 2 * c, contact) for s in (-e, 0.0, e)]
        bend = (path[0] - 2 * path[1] + path[2]) / e**2
        assert np.linalg.norm(bend - (bend @ h) * h) < 1e-5 * (1 + np.linalg.norm(c))


def test_samples_deliver_what_highs_says(arm):
    robot = arm("iiwa14")
    hit = hj.Hit(6, OBJECT, ALONG, 2.0, 0.2)
    limits = drive_limits(robot)
    samples = measured(robot, hit, limits, draw(robot, hit, robot.home, 0))
    across = np.linalg.svd(ALONG[None])[2][1:]
    for i in range(0, len(samples.q), 50):
        J = jacobian(robot, samples.q[i], 6)
        np.testing.assert_allclose(position(robot, samples.q[i], 6), OBJECT, atol=1e-8)
        ends = list(zip(samples.lower[i], samples.upper[i], strict=True))
        best = linprog(-ALONG @ J, A_eq=across @ J, b_eq=[0, 0], bounds=ends)
        inertia = hj.directional_inertia(robot, samples.q[i], 6, ALONG)
        assert samples.inertia[i] == pytest.approx(inertia, rel=1e-9)
        share = inertia / (inertia + 2.0)
        assert samples.flux[i] == pytest.approx(-best.fun * share, abs=1e-5)


def test_the_nearest_turn_is_taken(arm):
    robot = arm("xarm7")
    rng = np.random.default_rng(7)
    near = rng.uniform(*robot.finite_limits)
    q = rng.uniform(*robot.finite_limits, (200, robot.n))
    found = folded(robot, q, near)
    assert ((found >= robot.lower) & (found <= robot.upper)).all()
    turns = (found - q) / (2 * np.pi)
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
    for shift in (-2 * np.pi, 2 * np.pi):
        other = found + shift
        inside = (other >= robot.lower) & (other <= robot.upper)
        assert (np.abs(other - near) >= np.abs(found - near) - 1e-9)[inside].all()


def test_few_looks_show_that_a_way_is_clear(arm):
    """Against looking at every row."""
    robot = arm("iiwa14")
    room, rng, verdicts = Room(robot, 0.005, 0.0, SIZE), np.random.default_rng(8), set()
    for _ in range(25):
        start, end = rng.uniform(robot.lower, robot.upper, (2, 7))
        rows = start + 0.3 * np.linspace(0, 1, 150)[:, None] * (end - start)
        seen = room.check(rows, None)
        each = [room.check(row[None], None).least for row in rows]
        assert (seen.row is None) == (min(each) >= 0.005)
        if seen.row is not None:
            assert each[seen.row] == pytest.approx(seen.least)
            assert room.touches(rows[seen.row], None)
        else:
            sharp = room.check(rows, None, sharp=True)
            assert sharp.least == pytest.approx(min(each), abs=SHARP)
        verdicts.add(seen.row is None)
    assert verdicts == {True, False}


def test_unknown_limits_are_said_and_never_assumed(arm):
    with pytest.raises(InputError, match="xarm7 does not tell its acceleration limits"):
        drive_limits(arm("xarm7"))
    limits = drive_limits(arm("xarm7"), 10.0)
    assert set(limits.unknown) == {"jerk", "rotor inertia"}
    assert (limits.jerk == 10.0 * SHAPING).all()
    assert drive_limits(arm("panda")).unknown == ()
    assert drive_limits(arm("iiwa14")).unknown == ("jerk",)
    for wrong in (0.0, -1.0, np.nan, np.inf, [1.0, 2.0], "fast", [1] * 6 + [0]):
        with pytest.raises(InputError, match="acceleration"):
            drive_limits(arm("iiwa14"), wrong)
        with pytest.raises(InputError, match="jerk"):
            drive_limits(arm("iiwa14"), 1.0, wrong)


def test_swerves_leave_the_contacts_path_near_the_impact(arm):
    """They add nothing sideways to what the least bending has, and are within accelerations."""
    robot, hit = arm("panda"), hj.Hit(7, OBJECT, ALONG, 2.0, 0.2)
    limits, rng = drive_limits(robot), np.random.default_rng(9)
    samples = measured(robot, hit, limits, draw(robot, hit, robot.home, 0))
    across = np.linalg.svd(ALONG[None])[2][1:]
    for row in np.argsort(-samples.flux)[:5]:
        J, speed = samples.J[row], 0.5 * samples.flux[row]
        qd = impact_velocity(J, ALONG, samples.lower[row], samples.upper[row], speed)
        families = WindUpFamilies(robot, hit, limits, StateAtHit(samples.q[row], qd, J, speed))
        bent = families.straight().curvature[0]
        swerves = families.swerving(rng).curvature
        sideways = (across @ J @ (swerves - bent).T).T
        np.testing.assert_allclose(sideways, 0.0, atol=1e-6)
        assert np.abs(swerves - bent).max() > 0.1
        assert (np.abs(swerves - bent) <= limits.acceleration).all()


def test_looking_around_the_best_finds_better_ones(arm):
    robot, hit = arm("iiwa14"), hj.Hit(6, OBJECT, ALONG, 2.0, size=SIZE)
    room = Room(robot, 0.005, None, SIZE)
    among = HitCandidates(SwingTask(robot, hit, drive_limits(robot), room, robot.home), 0)
    first = max(f for i, f in enumerate(among.samples.flux) if not among.clear(i)[1])
    best = among.improve()
    assert best >= first
    assert best <= among.greatest
    for q in among.samples.q[-50:]:
        np.testing.assert_allclose(position(robot, q, 6), OBJECT, atol=1e-8)
        assert ((q >= robot.lower) & (q <= robot.upper)).all()
    proved = hj.plan(robot, OBJECT, ALONG, 2.0, [6], "deliverable", away=False, certificate=False)
    assert among.find_greatest() == pytest.approx(proved.best.deliverable_flux, rel=2e-3)


def test_configurations_near_the_start_come_first(arm):
    robot, hit = arm("iiwa14"), hj.Hit(7, OBJECT, ALONG, 2.0, 0.2)
    samples = measured(robot, hit, drive_limits(robot), draw(robot, hit, robot.home, 0))
    chosen = np.flatnonzero(samples.flux >= 0.2)
    rows = list(spread_out(robot, hit, samples, chosen, robot.home, 5))
    assert sorted(rows) == chosen.tolist()
    idle = np.array([1.0] * 6 + [0.25])
    far = (np.abs(samples.q - robot.home) * idle).max(axis=1)
    assert far[rows[0]] == far[chosen].min()
    assert (np.diff(far[rows[:5]]) >= 0).all()
    for i, j in itertools.combinations(rows[:5], 2):
        assert np.linalg.norm(samples.q[i] - samples.q[j]) >= 0.5
    # Then the farthest from all before.
    gaps = np.linalg.norm((samples.q[chosen][:, None] - samples.q[rows[:5]]) * idle, axis=2)
    assert rows[5] == chosen[int(np.argmax(gaps.min(axis=1)))]


def test_stops_are_the_wind_ups_run_backwards():
    """Of the same curve and ramp, mirrored in time: q + v s + c s^2 / 2, the sign of s changed."""
    rng = np.random.default_rng(10)
    q, v, c = rng.standard_normal((3, 4))
    ramp = ramp_of(rng.uniform(1.0, 2.0, 4), np.full(4, 5.0), np.full(4, 90.0))
    t = rng.uniform(0.0, 2.2, (30, 1))
    up, down = winding_up(q, v, c, ramp, -t), slowing_down(q, -v, c, 0.0, ramp, t)
    for sign, one, other in zip((1, -1, 1, -1), up, down, strict=True):
        np.testing.assert_allclose(other, sign * one, atol=1e-9)
