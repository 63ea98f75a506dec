"""Limits of an arm's joints that are told beside its description."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError, ModelError, shown
from hitjoints.vectors import real

if TYPE_CHECKING:
    from hitjoints.model.tree import Connection


def with_limits(
    chain: Sequence[Connection], limits: Mapping[str, Any], source: str
) -> list[Connection]:
    """Return the joints of a chain with other limits than the description's.

    Args:
        chain: the moving joints, base to tip.
        limits: "position" (n pairs lower, upper; rad or m; both infinite for none), "velocity"
            and "effort" (n each; rad/s, N m), as far as they are told.
        source: what to call the description in messages.

    Raises:
        ModelError: wrong count, or no limits.
    """
    joints = list(chain)
    for key, values in limits.items():
        n, pairs = len(joints), key == "position"
        shape, wanted = ((n, 2), f"{n} pairs [lower, upper]") if pairs else ((n,), f"{n} numbers")
        try:
            array = real(values, key, wanted)
        except InputError:
            array = np.empty(0)
        if array.shape != shape or np.isnan(array).any():
            raise ModelError(source, f"{key} = {shown(values)} must be {wanted}, one per joint")
        if pairs:
            ends = zip(joints, array[:, 0], array[:, 1], strict=True)
            joints = [_ranged(joint, low, high, source) for joint, low, high in ends]
        elif not ((array >= 0) & np.isfinite(array)).all():
            raise ModelError(source, f"{key} = {shown(values)} must be finite and not negative")
        else:
            values_of: list[dict[str, Any]] = [{key: float(value)} for value in array]
            joints = [replace(j, **v) for j, v in zip(joints, values_of, strict=True)]
    return joints


def _ranged(joint: Connection, lower: float, upper: float, source: str) -> Connection:
    if joint.kind != "prismatic" and lower == -np.inf and upper == np.inf:
        return replace(joint, kind="continuous")
    if not (np.isfinite([lower, upper]).all() and lower <= upper):
        reason = f"position [{lower:g}, {upper:g}] must be a lower and an upper limit"
        raise ModelError(source, f"joint {joint.name}: {reason}, or both infinite for none")
    kind = "revolute" if joint.kind == "continuous" else joint.kind
    return replace(joint, kind=kind, lower=float(lower), upper=float(upper), has_limit=True)
