"""Several hits, one after the other: where one would have to be too hard, or comes from no side."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from hitjoints.answers.way_graph import WayGraph
from hitjoints.errors import InputError

if TYPE_CHECKING:
    from hitjoints.answers.answer_record import Answer
    from hitjoints.answers.single_hit import SingleHit
    from hitjoints.answers.way_graph import Leg
    from hitjoints.hit import Hit

MOST_TRIED = 12
"""Hits of ways that are planned for real and turn out not to be, before giving up."""


def sequence(single: SingleHit, hit: Hit) -> tuple[tuple[Answer, ...], str]:
    """Return the hits that move an object to its goal, each planned for real.

    Args:
        single: answers one hit.
        hit: what is wanted; its setting says how many hits it may take.

    Returns:
        One answer for each hit, in order; or none, and why not.

    Raises:
        InputError: the hit has no goal.
    """
    if hit.goal is None:
        raise InputError("hits", hit.setting.hits, "several hits need a goal to go to")
    graph = WayGraph(single.robot, hit)
    made: dict[tuple[int, ...], Answer] = {}
    reason = ""
    for _ in range(MOST_TRIED):
        way = graph.best(hit.setting.hits)
        if not way:
            break
        for k in range(1, len(way)):
            behind = tuple(way[: k + 1])
            if behind not in made:
                before = made.get(behind[:-1])
                made[behind] = single.answer(_of(hit, graph.leg(way[k - 1], way[k]), before))
            if made[behind].verdict != "sendable":
                reason = made[behind].reason
                graph.forbid(way[k - 1], way[k])
                break
        else:
            return tuple(made[tuple(way[: k + 1])] for k in range(1, len(way))), ""
    most = f"no way of at most {hit.setting.hits} hits was found"
    return (), most + (f" (the last one tried: {reason})" if reason else "")


def _of(hit: Hit, leg: Leg, before: Answer | None) -> Hit:
    """Return one hit of a sequence: it begins where the one before left object and arm."""
    setting = replace(hit.setting, hits=1)
    if before is not None and before.swing is not None:
        setting = replace(setting, q0=tuple(before.swing.joints.q[-1].tolist()))
    told: dict[str, Any] = {"position": leg.start, "goal": leg.end, "setting": setting}
    if hit.size is not None:
        along, across, up = hit.size
        told |= {"yaw": leg.yaw, "size": (across, along, up) if leg.turned else hit.size}
    return hit.changed(**told)
