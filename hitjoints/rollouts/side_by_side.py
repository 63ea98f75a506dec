"""Roll thousands of hits out at once."""

from __future__ import annotations

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING, Literal

import numpy as np

from hitjoints.errors import InputError
from hitjoints.hit import Hit
from hitjoints.hitting.approach import Impact, why_no_hit
from hitjoints.hitting.controller import Controller, ReferenceName
from hitjoints.hitting.desired import Weighting
from hitjoints.hitting.step import Gains
from hitjoints.kernels.tape.rows import available_cpus
from hitjoints.rollouts.lanes import Lanes, Way
from hitjoints.rollouts.many_ends import slow_down, strike
from hitjoints.rollouts.many_record import Rollouts
from hitjoints.rollouts.many_starts import prepare_rows
from hitjoints.rollouts.record import why_not_sendable
from hitjoints.rollouts.tallies import Tallies
from hitjoints.vectors import whole

if TYPE_CHECKING:
    from typing import Any

    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

AT_ONCE = 2048
"""Rollouts that a thread moves side by side."""
MOST_THREADS = 256


def rollouts(  # noqa: PLR0913
    robot: Robot,
    hits: Hit | Sequence[Hit],
    q0: ArrayLike,
    *,
    q_hit: ArrayLike | None = None,
    dt: float = 0.002,
    reference: ReferenceName = "optimised",
    weighting: Weighting = "identity",
    gains: Gains | None = None,
    speed_profile: Literal["paper", "constant"] = "constant",
    threads: int | None = None,
) -> Rollouts:
    """Roll hits out side by side, many in a lane of a processor each.

    Every one is what `rollout` makes of the same arguments, to rounding: the same steps with the
    same proofs, and where a lane has none, the certifying way takes that step. A row that `rollout`
    would refuse has the refusal as its reason.

    Args:
        robot: the arm.
        hits: one for all rows, or one for each.
        q0: (n,) or (N, n) rad, where the motions start.
        q_hit: (n,) or (N, n) rad, the hitting configurations; found from q0 by default.
        dt: see `Controller`.
        reference: see `Controller`.
        weighting: see `Controller`.
        gains: see `Controller`.
        speed_profile: see `Controller`.
        threads: all available processors when not given. The result does not depend on it.

    Returns:
        What each comes to, as arrays.

    Raises:
        InputError: an argument cannot be used.
    """
    q0 = robot.configuration(q0, "q0")
    asked = [hits] if isinstance(hits, Hit) else list(hits)
    end = None if q_hit is None else robot.configuration(q_hit, "q_hit")
    counts = [len(asked), *(len(q) for q in (q0, end) if q is not None and q.ndim == 2)]
    count = max(counts)
    if not all(isinstance(hit, Hit) for hit in asked) or not set(counts) <= {1, count}:
        given = " and ".join(map(str, counts))
        raise InputError("hits", given, "as many hits and configurations, or one for all")
    asked *= count // max(len(asked), 1)
    q0 = np.array(np.broadcast_to(q0, (count, robot.n)))
    end = None if end is None else np.array(np.broadcast_to(end, (count, robot.n)))
    way = Way(float(dt), reference, weighting, gains or Gains(), speed_profile)
    middle = np.clip(robot.home, robot.lower, robot.upper)
    # A controller refuses what none can use; which hit it is for does not matter.
    Controller(
        robot, asked[0], middle, inertia=1.0, posture=middle, compiled=False, **way._asdict()
    )
    contacts = [robot.contact(hit.chosen_contact) for hit in asked]
    pieces = []
    for contact in dict.fromkeys(contacts):
        rows = np.flatnonzero([each == contact for each in contacts])
        pieces += [(contact, rows[i : i + AT_ONCE]) for i in range(0, rows.size, AT_ONCE)]

    def run(piece: tuple[Contact, Any]) -> tuple[Any, dict[str, Any]]:
        contact, rows = piece
        chosen = [asked[i] for i in rows]
        return rows, _piece(
            robot, contact, chosen, q0[rows], None if end is None else end[rows], way
        )

    workers = available_cpus() if threads is None else whole(threads, "threads", 1, MOST_THREADS)
    if min(workers, len(pieces)) > 1:
        with ThreadPoolExecutor(workers) as pool:
            found = list(pool.map(run, pieces))
    else:
        found = [run(piece) for piece in pieces]
    parameters = way._asdict() | {"gains": list(way.gains)}
    return Rollouts(robot, tuple(asked), parameters=parameters, **_joined(count, found))


def _piece(
    robot: Robot,
    contact: Contact,
    hits: Sequence[Hit],
    q0: Array,
    q_hit: Array | None,
    way: Way,
) -> dict[str, Any]:
    """Return the results of some rollouts by name, (N, ...)."""
    starts = prepare_rows(robot, contact, hits, q0, q_hit, way.dt)
    lanes, tallies = (
        Lanes(robot, contact, starts, way),
        Tallies(robot, way.dt, np.zeros(q0.T.shape)),
    )
    found = lanes.approach(tallies)
    impact = strike(robot, contact, lanes, found, tallies.qd)
    slow_down(robot, contact, lanes, found, tallies)
    reason = list(found.reason)
    for i, hit in enumerate(hits):
        if not reason[i]:
            reason[i] = why_no_hit(hit, Impact(**{name: v[i] for name, v in impact.items()}))
    rest = np.abs(tallies.qd).max(axis=0)
    ratios = tallies.acceleration_ratio_max, tallies.torque_ratio_max
    moved = zip(found.steps.tolist(), *(r.tolist() for r in (*ratios, rest)), strict=True)
    why = [why_not_sendable(*numbers) if steps else "it did not move" for steps, *numbers in moved]
    return impact | {
        "reason": np.array(reason, dtype=object),
        "why": np.array(why, dtype=object),
        "q0": starts.q0,
        "q_hit": starts.q_hit,
        "steps": found.steps,
        "saturated_steps": found.saturated_steps,
        "braked_steps": found.braked_steps,
        "certified_steps": found.certified_steps,
        "velocity_ratio_max": tallies.velocity_ratio_max,
        "position_violation_max": tallies.position_violation_max,
        "torque_ratio_max": tallies.torque_ratio_max,
        "acceleration_ratio_max": tallies.acceleration_ratio_max,
    }


def _joined(count: int, found: list[tuple[Any, dict[str, Any]]]) -> dict[str, Any]:
    """Return the results of all pieces in the order of the rows."""
    joined: dict[str, Any] = {}
    for rows, part in found:
        for name, values in part.items():
            if name not in joined:
                joined[name] = np.empty((count, *values.shape[1:]), dtype=values.dtype)
            joined[name][rows] = values
    return joined
