"""An object's numbers from past hits, and how well they foresee a hit that they do not know."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import InputError
from hitjoints.evidence.calibration.landing_law import LEVEL, LandingInterval, LandingLaw
from hitjoints.evidence.calibration.landing_rows import PastLanding, read
from hitjoints.plotted import Plotted
from hitjoints.told import Told

if TYPE_CHECKING:
    from numpy.typing import NDArray

RESTITUTION = 0.5
"""Assumed where only landings are known: they tell (1 + eps)^2 / mu, not the two of them."""
LEAST_ROWS = 8
"""Of an arm, to judge the law by leaving one out."""


class HeldOut(NamedTuple):
    """How well a landing is foreseen from all others.

    Attributes:
        rows: how many were foreseen.
        held: of them, within their interval.
        coverage: the same as a share.
        error: m, the mean distance between foreseen and measured.
        baseline_error: m, the same of distance = c flux^2, c of the arm's other rows.
        width: m, the mean width of the intervals.
    """

    rows: int
    held: int
    coverage: float
    error: float
    baseline_error: float
    width: float


@dataclass(frozen=True, eq=False, repr=False)
class Calibration(Told, Plotted):
    """What past hits tell of an object.

    Attributes:
        landings: the rows.
        notes: what was left out or assumed.
        object: `restitution`, `friction` and their standard deviations `spread`, for a hit.
        law: of the landings; None where no box was followed to its rest.
    """

    drawn_by: ClassVar[str] = "calibration"

    landings: tuple[PastLanding, ...] = field(repr=False)
    notes: tuple[str, ...]
    object: dict[str, Any]
    law: LandingLaw | None = field(repr=False)

    @property
    def rows(self) -> int:
        """How many hits were used."""
        return len(self.landings)

    @cached_property
    def foreseen(self) -> tuple[tuple[PastLanding, LandingInterval], ...]:
        """Each landing whose arm has enough of them, foreseen from all the others."""
        followed = _followed(self.landings)
        counts = {row.arm: sum(one.arm == row.arm for one in followed) for row in followed}
        found = []
        for i, row in enumerate(followed):
            if counts[row.arm] >= LEAST_ROWS:
                found.append((row, LandingLaw(followed[:i] + followed[i + 1 :]).foresee(row)))
        return tuple(found)

    @cached_property
    def held_out(self) -> HeldOut | None:
        """How well they are foreseen; None where there are too few."""
        if not self.foreseen:
            return None
        rows = [row for row, _ in self.foreseen]
        distance = np.array([row.distance for row in rows])
        middle, low, high = np.array([interval for _, interval in self.foreseen]).T
        held = int(((low <= distance) & (distance <= high)).sum())
        return HeldOut(
            len(rows),
            held,
            held / len(rows),
            float(np.abs(middle - distance).mean()),
            float(np.abs(_plain_law(rows) - distance).mean()),
            float((high - low).mean()),
        )

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it."""
        held = self.held_out
        return {
            "object": self.object,
            "rows": self.rows,
            "interval": None if held is None else {"level": LEVEL, "width": held.width},
            "held_out": None if held is None else held._asdict(),
            "arms": {} if self.law is None else _arms(self.law),
            "scatter": None if self.law is None else self.law.scatter,
            "notes": list(self.notes),
        }

    def toml(self) -> str:
        """Return the object's part of a hit's file."""
        numbers = [f"{k} = {v:.4g}" for k, v in self.object.items() if k != "spread"]
        spread = ", ".join(f"{k} = {v:.4g}" for k, v in self.object["spread"].items())
        return "\n".join(["[object]", *numbers, f"spread = {{ {spread} }}  # standard deviations"])


def calibrate(
    files: str | Path | Iterable[str | Path], *, restitution: float | None = None
) -> Calibration:
    """Find an object's restitution and friction, and the law of its landings, from past hits.

    Args:
        files: landing tables (CSV with a line per hit: `flux`, `distance`, and `arm`, `hit_x`,
            `start_x`, `yaw_qz` where known), recordings and folders of them (see `replay`).
        restitution: of the object; None: as recorded, or 0.5 where only landings are known.

    Returns:
        The object's numbers; `foreseen` and `held_out` judge the law on rows it did not see.

    Raises:
        InputError: a file cannot be used, or nothing in them can.
    """
    if restitution is not None and not 0 <= restitution <= 1:
        raise InputError("restitution", restitution, "it must lie from 0 to 1")
    landings = read([files] if isinstance(files, (str, Path)) else files)
    notes = list(landings.notes)
    followed = _followed(landings.rows)
    law = LandingLaw(followed) if followed else None
    found = _object(landings.rows, law, restitution, notes)
    return Calibration(landings.rows, tuple(notes), found, law)


def _followed(rows: Sequence[PastLanding]) -> tuple[PastLanding, ...]:
    return tuple(row for row in rows if not math.isnan(row.flux + row.distance))


def _object(
    rows: Sequence[PastLanding], law: LandingLaw | None, restitution: float | None, notes: list[str]
) -> dict[str, Any]:
    """Return restitution and friction with their spread: measured, or as landings tell them."""
    bounced = np.array([row.restitution for row in rows if not math.isnan(row.restitution)])
    slid = np.array([row.friction for row in rows if not math.isnan(row.friction)])
    spread: dict[str, float] = {}
    if restitution is None and len(bounced):
        restitution = min(1.0, max(0.0, float(np.median(bounced))))
        spread["restitution"] = _deviation(bounced)
    elif restitution is None:
        restitution = RESTITUTION
        notes.append(f"restitution {RESTITUTION:g} is assumed: landings tell (1 + eps)^2 / mu only")
    if len(slid):
        friction, spread["friction"] = float(np.median(slid)), _deviation(slid)
    elif law is not None:
        reach = np.array([row.distance / row.flux**2 for row in _followed(rows)])
        friction = float((1 + restitution) ** 2 / (2 * GRAVITY * np.median(reach)))
        spread["friction"] = friction * float(np.std(np.log(reach), ddof=min(1, len(reach) - 1)))
        notes.append("all scatter of the distances is put down to friction")
    else:
        return {"restitution": restitution, "spread": spread}
    return {"restitution": restitution, "friction": friction, "spread": spread}


def _deviation(values: NDArray[np.float64]) -> float:
    return float(np.std(values, ddof=1)) if len(values) > 1 else 0.0


def _plain_law(rows: Sequence[PastLanding]) -> NDArray[np.float64]:
    """Return distance = c flux^2 of each row, c by least squares of its arm's other rows."""
    arms = np.array([row.arm for row in rows])
    square = np.array([row.flux**2 for row in rows])
    distance = np.array([row.distance for row in rows])
    told = np.empty(len(rows))
    for i in range(len(rows)):
        others = (arms == arms[i]) & (np.arange(len(rows)) != i)
        told[i] = (
            square[i] * (square[others] @ distance[others]) / (square[others] @ square[others])
        )
    return told


def _arms(law: LandingLaw) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for arm, one in law.arms.items():
        heading = None
        if one.heading is not None:
            names = ("constant", "offset", "yaw")
            heading = dict(zip(names, one.heading[0].tolist(), strict=True))
            heading["scatter"] = one.heading[1]
        terms = dict(zip(one.names, one.coefficients.tolist(), strict=True))
        found[arm] = {"flux": one.middle, "terms": terms, "heading": heading}
    return found
