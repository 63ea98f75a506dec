"""From a wish to a verdict: `hj.answer`."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from hitjoints.answers.hit_sequence import sequence
from hitjoints.answers.single_hit import SingleHit
from hitjoints.answers.way_graph import WayGraph
from hitjoints.errors import InputError
from hitjoints.planning.objectives.registry import objective_named

if TYPE_CHECKING:
    from hitjoints.answers.answer_record import Answer
    from hitjoints.answers.nearest import Nearest
    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot

FEW = 3
"""Hits of a way that is offered where one cannot do it."""


def answer(
    hit: Hit,
    robot: Robot | None = None,
    *,
    tolerance: float | None = None,
    simulated: bool | None = None,
) -> Answer:
    """Take a wish to its verdict: the joint, a motion that can be sent, where the object ends.

    The joints are tried in the order of the flux they can deliver from rest to rest, until one has
    a motion; with the objective "landing" the one is taken whose object most surely arrives. Where
    one hit cannot do it, and the wish allows several, a sequence is looked for.

    Args:
        hit: what is wanted; its setting says with which arm and how.
        robot: the arm, if it is loaded already.
        tolerance: m, around the goal; by default the hit's.
        simulated: look at the motion in the physics engine; by default if that is installed.

    Raises:
        InputError: an argument cannot be used, or the arm's acceleration limits are not known.
        MissingExtraError: the physics engine was asked for, and is not installed.
    """
    arm = hit.setting.arm(robot)
    hit = hit.made_by(arm)
    if tolerance is not None:
        hit = hit.changed(setting=replace(hit.setting, tolerance=tolerance))
    objective_named(hit.setting.objective)
    single, several = SingleHit(arm, simulated), hit.setting.hits > 1
    if several and hit.goal is None:
        raise InputError("hits", hit.setting.hits, "several hits need a goal to go to")
    one = single.answer(hit)
    if one.verdict != "no":
        return replace(one, hits=(one,)) if several else one
    nearest = single.nearest(one)
    if not several:
        return replace(one, nearest=_with_way(arm, hit, nearest))
    made, reason = sequence(replace(single, proved=False), hit)
    if not made:
        return replace(one, nearest=nearest, hits=(), reason=f"{one.reason}; {reason}")
    first = made[0]
    return replace(first, hit=hit, hits=made)


def _with_way(arm: Robot, hit: Hit, nearest: Nearest | None) -> Nearest | None:
    """Return what can be had instead, with a way of several hits if the map knows one."""
    if hit.goal is None or nearest is None:
        return nearest
    graph = WayGraph(arm, hit)
    way = graph.best(FEW)
    return (
        replace(nearest, way=tuple(graph.places[place] for place in way[1:-1])) if way else nearest
    )
