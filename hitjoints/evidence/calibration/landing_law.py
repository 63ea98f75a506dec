"""The law of an arm's landings, as it is found in them: empirical, with its interval.

log distance = a + p log(flux / middle) + b offset + c yaw + e yaw log(flux / middle)

A box without friction at its contact would not go like that: one degree of yaw turns the way by 3
to 6 degrees where that law has one. So nothing is derived here, and nothing outside the rows is
claimed. The scatter is one for all arms: they hit one object on one table.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.evidence.calibration.landing_rows import PastLanding

if TYPE_CHECKING:
    from hitjoints.types import Array

LEVEL, NORMAL = 0.9, 1.6448536269514722
"""Share of landings that an interval holds, and the normal distribution's quantile for it."""
PLAIN = ("one",)
"""The terms of distance = c flux^2."""
ROWS_PER_TERM = 3
"""Fewer rows of an arm than this for each term: the plain law is all."""
TURNED = 0.5
"""rad, of the median yaw: more is a frame that is turned, not boxes that are."""


class LandingInterval(NamedTuple):
    """A landing foreseen: distances in m, the middle one and where 9 in 10 lie between."""

    distance: float
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class ArmLaw:
    """What one arm's landings tell.

    Attributes:
        middle: m/s, the geometric mean of the fluxes.
        names: of the terms.
        coefficients: (T,) of each.
        spread: (T, T), the coefficients' covariance over the scatter's square.
        freedom: rows less terms.
        squares: the sum of the squared residuals, of log distance.
        heading: of the way, by terms 1, offset and yaw (rad), and its standard deviation; None
            where it is not known.
    """

    middle: float
    names: tuple[str, ...]
    coefficients: Array
    spread: Array
    freedom: int
    squares: float
    heading: tuple[Array, float] | None

    def of(self, rows: Sequence[PastLanding]) -> tuple[Array, Array]:
        """Return what a row's log distance has without coefficients (N,), and its terms (N, T)."""
        return _terms(self.names, self.middle, rows)


class LandingLaw:
    """The laws of all arms in some landings, with one scatter.

    Args:
        rows: with flux and distance.
    """

    def __init__(self, rows: Sequence[PastLanding]) -> None:
        self.names = usable_terms(rows)
        self.arms = {
            arm: _fit([row for row in rows if row.arm == arm], self.names)
            for arm in sorted({row.arm for row in rows})
        }
        self.freedom = sum(law.freedom for law in self.arms.values())
        squares = sum(law.squares for law in self.arms.values())
        self.scatter = math.sqrt(squares / self.freedom) if self.freedom > 0 else math.nan

    def foresee(self, row: PastLanding) -> LandingInterval:
        """Return how far a box goes that is hit like this; its own distance is not looked at."""
        law = self.arms[row.arm]
        (known,), (terms,) = law.of([row])
        middle = float(known + terms @ law.coefficients)
        doubt = self.scatter * math.sqrt(1.0 + float(terms @ law.spread @ terms))
        half = student(self.freedom) * doubt
        return LandingInterval(math.exp(middle), math.exp(middle - half), math.exp(middle + half))


def student(freedom: int) -> float:
    """Return Student's two-sided quantile for `LEVEL`, by its expansion in 1 / freedom."""
    z, n = NORMAL, float(freedom)
    third = (3 * z**7 + 19 * z**5 + 17 * z**3 - 15 * z) / (384 * n**3)
    return z + (z**3 + z) / (4 * n) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * n**2) + third


def usable_terms(rows: Sequence[PastLanding]) -> tuple[str, ...]:
    """Return the terms that landings can tell: those known in all of them, of boxes that face."""
    names = ["one", "flux"]
    if not any(math.isnan(row.offset) for row in rows):
        names.append("offset")
    yaws = [row.yaw for row in rows]
    if not any(map(math.isnan, yaws)) and np.median(np.abs(yaws)) < TURNED:
        names += ["yaw", "yaw flux"]
    return tuple(names)


def _fit(rows: Sequence[PastLanding], names: tuple[str, ...]) -> ArmLaw:
    middle = math.exp(float(np.mean([math.log(row.flux) for row in rows])))
    if len(rows) < ROWS_PER_TERM * len(names):
        names = PLAIN
    known, terms = _terms(names, middle, rows)
    target = np.log([row.distance for row in rows]) - known
    inverse = np.asarray(np.linalg.pinv(terms.T @ terms), dtype=float)
    coefficients = inverse @ terms.T @ target
    left = target - terms @ coefficients
    freedom = len(rows) - terms.shape[1]
    return ArmLaw(
        middle, names, coefficients, inverse, freedom, float(left @ left), _heading(rows, names)
    )


def _terms(
    names: tuple[str, ...], middle: float, rows: Sequence[PastLanding]
) -> tuple[Array, Array]:
    """Return what is known of log distance beforehand (N,), and the terms (N, T)."""
    flux = np.log([row.flux / middle for row in rows])
    offset, yaw = np.array([row.offset for row in rows]), np.array([row.yaw for row in rows])
    columns = {
        "one": np.ones(len(rows)),
        "flux": flux,
        "offset": offset,
        "yaw": yaw,
        "yaw flux": yaw * flux,
    }
    known = 2.0 * flux if names == PLAIN else np.zeros(len(rows))
    return known, np.column_stack([columns[name] for name in names])


def _heading(rows: Sequence[PastLanding], names: tuple[str, ...]) -> tuple[Array, float] | None:
    """Return the way's direction by offset and yaw, and what is left of it (rad)."""
    target = np.array([row.heading for row in rows])
    if "yaw" not in names or "offset" not in names or np.isnan(target).any():
        return None
    terms = np.column_stack(
        [np.ones(len(rows)), [row.offset for row in rows], [row.yaw for row in rows]]
    )
    coefficients = np.linalg.lstsq(terms, target, rcond=None)[0]
    left = target - terms @ coefficients
    return coefficients, float(np.sqrt(left @ left / (len(rows) - 3)))
