"""Millions of configurations: the formulas compiled for one arm, checked against Pinocchio."""

from __future__ import annotations

from hitjoints.kernels.bounds import Bounds, bisect, build_bounds
from hitjoints.kernels.chain import Chain
from hitjoints.kernels.ik import Placement, place
from hitjoints.kernels.interval_backend import Interval
from hitjoints.kernels.kernel import Kernel, build_kernel

__all__ = [
    "Bounds",
    "Chain",
    "Interval",
    "Kernel",
    "Placement",
    "bisect",
    "build_bounds",
    "build_kernel",
    "place",
]
