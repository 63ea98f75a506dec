"""Tasks for the planner's parts, in one line."""

import numpy as np

from hitjoints.hit import Hit
from hitjoints.planning.task import Task


def task(robot, contact, direction, mass, target, away):
    """Return a task; a target of None leaves the contact free."""
    at = np.array([0.4, 0.2, 0.5]) if target is None else target
    return Task(robot, Hit(contact, at, direction, mass), target, away)
