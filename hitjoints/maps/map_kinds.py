"""The maps over object positions there are, and what their blocks hold."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Block = Mapping[str, NDArray[np.float64]]
    Absent = dict[str, NDArray[np.bool_]]

POSTURES = ("q", "q0", "q_hit")
"""Variables with a number for each joint of the arm."""


@dataclass(frozen=True)
class MapKind:
    """A kind of map.

    Attributes:
        name: as its attributes tell it.
        per_direction: variables (K, D, ...), a number each.
        postures: of `POSTURES`, those it has, (K, D, ..., n).
        absent: from a block's values, where the variables of a whole block have no number.
    """

    name: str
    per_direction: tuple[str, ...]
    postures: tuple[str, ...]
    absent: Callable[[Block], Absent]

    @property
    def blockwise(self) -> tuple[str, ...]:
        """The variables that a block has a part of."""
        return (*self.per_direction, *self.postures, "reachable")


def _out_of_reach(block: Block, like: str) -> NDArray[np.bool_]:
    return np.broadcast_to((block["reachable"] == 0)[:, None], block[like].shape)


def _workspace_absent(block: Block) -> Absent:
    out = _out_of_reach(block, "away")
    names = (*WORKSPACE.per_direction, *WORKSPACE.postures)
    return dict.fromkeys(names, out) | {"away_flux": block["away"] != 1}


def _motion_absent(block: Block) -> Absent:
    missed = ~(block["hits"] > 0)
    # Ratios to limits that a robot does not tell are unknown everywhere.
    names = [name for name in (*MOTION.per_direction, *MOTION.postures) if "ratio" not in name]
    return dict.fromkeys(names, missed) | {"hits": _out_of_reach(block, "hits")}


# Of a workspace map, names without an ending belong to the best configuration, the one of the
# greatest flux, so that each can be checked at its `q`.
WORKSPACE = MapKind(
    "workspace",
    (
        "inertia", "inertia_min", "inertia_median", "inertia_max",
        "speed", "speed_max", "flux", "flux_median",
        "straight_speed", "straight_flux", "away", "away_flux",
    ),
    ("q",),
    _workspace_absent,
)  # fmt: skip
# Of a map of motions, all belong to the one that delivers the greatest flux, but for `hits`.
MOTION = MapKind(
    "motion",
    (
        "flux", "inertia", "speed", "straight_flux", "miss", "direction_error", "time", "hits",
        "acceleration_ratio", "torque_ratio",
    ),
    POSTURES,
    _motion_absent,
)  # fmt: skip
KINDS = {kind.name: kind for kind in (WORKSPACE, MOTION)}


def kind_of(attributes: Mapping[str, Any]) -> MapKind:
    """Return which kind of map has these attributes."""
    return KINDS[attributes.get("map", WORKSPACE.name)]
