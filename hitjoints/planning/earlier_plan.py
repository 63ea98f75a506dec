"""Where an earlier plan had a joint, for a hit that was little different."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError
from hitjoints.planning.plan_record import Plan

if TYPE_CHECKING:
    from hitjoints.planning.task import Task
    from hitjoints.types import Array


def planned_at(previous: Plan, task: Task, digest: str) -> Array | None:
    """Return the configuration (1, n) rad that a plan has for a task's contact; None for none.

    Args:
        previous: the plan.
        task: what is asked now.
        digest: of the arm.

    Raises:
        InputError: it is no plan of this arm.
    """
    if not isinstance(previous, Plan) or previous.digest != digest:
        given = f"a plan for {previous.robot}" if isinstance(previous, Plan) else previous
        raise InputError("near", given, f"a plan for this {task.robot.name}")
    contact = (task.contact.joint, task.contact.offset)
    for one in previous.candidates:
        if one.feasible and (one.joint, one.offset) == contact:
            return np.atleast_2d(one.q)
    return None
