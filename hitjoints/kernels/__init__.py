"""Millions of configurations: the formulas compiled for one arm, checked against Pinocchio."""

from __future__ import annotations

from hitjoints.kernels.bounds import Bounds, bisect, build_bounds
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.ik import Placement, place
from hitjoints.kernels.kernel import Kernel, build_kernel
from hitjoints.kernels.tape.interval_backend import Interval

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
