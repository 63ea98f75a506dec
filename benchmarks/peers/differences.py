"""Gradients for libraries that have none of the directional inertia."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

CENTRAL, FORWARD = 1e-5, 1e-7  # rad, steps about which the errors of either kind are least


def central(value: Callable[[Any], float], q: Any) -> Any:
    """Return the gradient (n,) by 2 n evaluations, good to about nine digits."""
    steps = CENTRAL * np.eye(len(q))
    return np.array([value(q + step) - value(q - step) for step in steps]) / (2 * CENTRAL)


def forward(value: Callable[[Any], float], q: Any, here: float) -> Any:
    """Return the gradient (n,) by n evaluations besides `here`, good to about six digits."""
    return np.array([value(q + step) - here for step in FORWARD * np.eye(len(q))]) / FORWARD
