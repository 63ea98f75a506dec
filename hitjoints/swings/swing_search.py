"""Search a swing: choose where and how to strike, wind up, get there, and stop."""

from __future__ import annotations

import itertools
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.quantities import place_joint
from hitjoints.swings.hit_candidates import GRAVITY, NOT_BEFORE, NOT_CLEAR, STANDS, HitCandidates
from hitjoints.swings.strike_maker import TOO_SLOW, StrikeMaker, Struck
from hitjoints.swings.swing_record import Swing
from hitjoints.swings.wind_ups import RUN_UP

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from numpy.typing import ArrayLike

    from hitjoints.swings.swing_task import SwingTask
    from hitjoints.types import Array

CANDIDATES, ALL = 40, 120
"""Configurations whose strokes are looked at for one flux, and strikes all in all."""
NEAREST = 30
"""Configurations near the start that are looked at first for a flux that many can deliver."""
LEVELS = (0.999, 0.97, 0.93, 0.88, 0.8, 0.7, 0.57, 0.45, 0.33)
"""Shares of the greatest flux that are tried where no flux is asked for,"""
FEW = 4
"""from so many configurations each."""
HALVINGS = 4
"""Then the gap between what was found and the least that was not is halved so many times."""
SHORT = 0.996
"""Share of the flux asked for that counts as that: what is asked may be a rounded maximum."""
AT_THE_OBJECT = 1e-4
"""m, how far from the object a given configuration may hold the contact."""
ALWAYS = {NOT_CLEAR, NOT_BEFORE, GRAVITY}
"""Reasons against a configuration, whatever the stroke."""
STARTS = 100
"""Attempts at placing the contact behind the object."""


class SwingSearch:
    """Searches a swing of one arm for one hit.

    Args:
        task: what is asked.
        dt: s, spacing of the samples.
        seed: of the samples.
    """

    def __init__(self, task: SwingTask, dt: float, seed: int) -> None:
        self.task, self.dt, self.seed = task, dt, seed
        self.robot, self.hit, self.limits, self.room, self.start = task
        rng = np.random.default_rng(seed)
        self.contact = self.robot.contact(self.hit.chosen_contact)
        self.reasons: Counter[str] = Counter()
        self.maker = StrikeMaker(task, dt, rng, self.reasons)
        self.notes: list[str] = []
        self.best, self.struck = 0.0, 0
        self.told: set[int] = set()

    def swing(self, q_hit: ArrayLike | None) -> Swing:
        """Return the swing, from q_hit (n,) rad if it can be.

        Raises:
            InputError, InfeasibleError: as `swing`.
        """
        self._check_start()
        first = None if q_hit is None else self._at_object(q_hit)
        among = self.among = HitCandidates(self.task, self.seed, first)
        self._check_run_up()
        wanted, self.best = self.hit.flux, among.greatest
        if not self.best > 0:
            raise InfeasibleError("no configuration moves straight along the direction")
        if wanted is not None and wanted > self.best:
            self.best = among.find_greatest()
        if wanted is not None and wanted * SHORT > self.best:
            raise InfeasibleError(
                f"a flux of {wanted:.4g} m/s is beyond the maximum of {self.best:.4g} m/s that can "
                f"be delivered from rest with joint {self.contact.joint} at the object",
                {"maximum_flux": self.best, "flux": wanted},
            )
        found = None if first is None else self._given(wanted)
        if found is None:
            found = self._fastest() if wanted is None else self._wanted(wanted)
        if found is None:
            raise self._refusal(wanted)
        return found

    def _given(self, wanted: float | None) -> Swing | None:
        """Return a swing from the first configuration, or note that there is none."""
        most = float(self.among.samples.flux[0])
        asked = [share * most for share in LEVELS] if wanted is None else [min(wanted, most)]
        for flux in asked if most >= SHORT * (wanted or 0.0) else []:
            for struck in self._strikes([0], flux, 1, strict=False):
                found = self._checked(struck)
                if found is not None:
                    return found
        reason = ", ".join(self.reasons) or f"it delivers {most:.3g} m/s at most"
        self.notes.append(f"no swing from the q_hit asked for ({reason}): another is taken")
        return None

    def _wanted(self, flux: float) -> Swing | None:
        for strict in (True, False):
            rows = self.among.rows(SHORT * flux, NEAREST)
            for struck in self._strikes(rows, flux, CANDIDATES, strict=strict):
                found = self._checked(struck)
                if found is not None:
                    return found
        return None

    def _fastest(self) -> Swing | None:
        most = self.among.improve()
        self.best = max(self.best, self.among.greatest)
        most = most or self.best
        levels = [share * most for share in LEVELS]
        for strict in (True, False):
            for flux, above in zip(levels, [most, *levels], strict=False):
                many = CANDIDATES if flux == levels[-1] else FEW
                struck = next(self._strikes(self.among.rows(flux), flux, many, strict=strict), None)
                found = None if struck is None else self._faster(struck, flux, above)
                if found is not None:
                    return found
        return None

    def _faster(self, struck: Struck, flux: float, above: float) -> Swing | None:
        """Return a swing with as much more than the flux of one as is found."""
        made = [struck]
        for _ in range(HALVINGS):
            middle = 0.5 * (flux + above)
            again = [made[-1].row] if self.among.samples.flux[made[-1].row] >= middle else []
            rows = itertools.chain(again, self.among.rows(middle))
            more = next(self._strikes(rows, middle, FEW, strict=True), None)
            flux, above = (flux, middle) if more is None else (middle, above)
            made += [] if more is None else [more]
        checked = (self._checked(one) for one in reversed(made))
        return next((one for one in checked if one is not None), None)

    def _checked(self, struck: Struck) -> Swing | None:
        """Return the swing, if looking at it densely finds nothing against it."""
        reason, clear = self.maker.look(struck)
        if reason:
            self.reasons[reason] += 1
            return None
        found = Swing(
            self.robot,
            self.hit,
            self.limits,
            struck.motion,
            self.dt,
            struck.sample,
            clear.least if self.room.known else None,
            clear.what,
            self.best,
            dict(self.reasons),
            tuple(self.notes),
        )
        return found if found.sendable else None

    def _check_start(self) -> None:
        seen = self.room.check(self.start[None], None)
        if seen.row is not None:
            expected = f"{seen.what} are {seen.least:.3g} m apart there"
            raise InputError("q0", self.start.round(4).tolist(), expected)

    def _at_object(self, q: ArrayLike) -> Array:
        q = self.robot.within_limits(q, "q_hit")
        off = float(np.linalg.norm(position(self.robot, q, self.contact) - self.hit.position))
        if off > AT_THE_OBJECT:
            expected = f"it holds the contact {off:.3g} m off the object"
            raise InputError("q_hit", q.round(4).tolist(), expected)
        return np.array(place_joint(self.robot, self.contact, self.hit.position, start=q).q[0])

    def _check_run_up(self) -> None:
        """Refuse a hit for which the contact cannot begin far enough behind the object."""
        behind = self.hit.position - RUN_UP * self.hit.direction
        placed = place_joint(self.robot, self.contact, np.tile(behind, (STARTS, 1)), self.seed)
        if not placed.solved.any():
            raise InfeasibleError(
                f"no reachable run-up: joint {self.contact.joint} comes no nearer than "
                f"{placed.error.min():.3g} m to the point {100 * RUN_UP:g} cm behind the object",
                {"joint": self.contact.joint, "nearest": float(placed.error.min())},
            )

    def _strikes(
        self, rows: Iterable[int], flux: float, most: int, *, strict: bool
    ) -> Iterator[Struck]:
        """Yield motions that strike with a flux, from so many of the rows at most.

        Unless strict, those may hit that are only likely to touch the object before.
        """
        looked = 0
        for row in rows:
            box, reason = self.among.clear(row)
            if reason and (strict or reason != NOT_BEFORE):
                self.reasons[reason] += row not in self.told
                self.told.add(row)
                continue
            looked += 1
            if looked > most or self.struck >= ALL:
                break
            self.struck += 1
            struck = self.maker.strike(self.among.samples, row, flux, box)
            if struck is not None:
                yield struck

    def _refusal(self, wanted: float | None) -> InfeasibleError:
        data = {"tried": dict(self.reasons), "maximum_flux": self.best}
        if TOO_SLOW in self.reasons and set(self.reasons) <= {TOO_SLOW, *ALWAYS}:
            return InfeasibleError(f"the contact would move {TOO_SLOW}: ask for more flux", data)
        if STANDS in self.reasons and set(self.reasons) <= {STANDS, *ALWAYS}:
            return InfeasibleError(
                f"{STANDS}: at the start it touches the object, as it would be hit in the "
                f"{self.reasons[STANDS]} configurations that are clear otherwise",
                data,
            )
        if set(self.reasons) <= ALWAYS:
            return InfeasibleError(
                f"no clear configuration: the arm touches the object, the table or itself in all "
                f"{sum(self.reasons.values())} that could deliver it",
                data,
            )
        common = ", ".join(f"{word} ({count})" for word, count in self.reasons.most_common(3))
        what = "any flux" if wanted is None else f"{wanted:.4g} m/s"
        return InfeasibleError(f"no stroke found that delivers {what}: {common}", data)
