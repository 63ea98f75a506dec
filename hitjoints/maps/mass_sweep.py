"""Which joint hits best from which mass of the object on: `sweep_mass`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hitjoints.counting import counted
from hitjoints.datasets.describe import described
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.planning.planner import plan
from hitjoints.vectors import positive_mass

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.model.robot import Contact, Robot

OBJECTIVES = {"flux": "flux", "straight-flux": "straight_flux"}
"""Objectives that a mass decides on, and the name of their value."""
EXACT = 1e-6
"""Of a crossing's mass, relative."""
MOST_STEPS = 60
MOST_MASSES = 1000


class MassCrossing(NamedTuple):
    """From this mass (kg) on joint `after` is the best, until there joint `before`."""

    mass: float
    before: int
    after: int


Best = Callable[[float], dict[int, float]]


def sweep_mass(
    robot: Robot,
    position: ArrayLike,
    direction: ArrayLike,
    masses: ArrayLike,
    *,
    joints: Sequence[Contact | int] | None = None,
    objective: str = "flux",
    away: bool = True,
    seed: int = 0,
) -> Dataset:
    """Plan a hit with every joint for objects of several masses, and find where the best changes.

    A light object is hit hardest by the fastest joint, a heavy one by the one with most inertia
    behind it (Eq. 10). Between two masses with different best joints their values are made equal,
    each value that of a plan of its own. Two changes that undo each other between neighbouring
    masses are not seen.

    Args:
        robot: the arm.
        position: (3,) m, of the object.
        direction: (3,), the hitting direction.
        masses: (M,) kg, ascending.
        joints: hitting joints or contacts; the robot's own when not given.
        objective: "flux" or "straight-flux", as for `plan`.
        away: demand the away condition (Eq. 14).
        seed: of the plans' samples.

    Returns:
        A data set over (joint, mass): flux, inertia, speed and q of each joint's best
        configuration, nan for a joint that cannot do it; over mass: best. With crossings, over
        crossing: crossing_mass, crossing_before, crossing_after.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: no joint can hit the object so.
    """
    if objective not in OBJECTIVES:
        raise InputError("objective", repr(objective), f"choose one of {', '.join(OBJECTIVES)}")
    samples = np.atleast_1d(np.asarray(masses, dtype=float))
    if samples.ndim != 1 or not 1 <= samples.size <= MOST_MASSES or (np.diff(samples) <= 0).any():
        raise InputError("mass", np.array2string(samples, threshold=6), "ascending masses (kg)")
    for mass in samples:
        positive_mass(float(mass))
    planned = _Planned(robot, position, direction, robot.contacts(joints), objective, away, seed)
    values = [planned.best(float(mass)) for mass in counted(samples, "masses")]
    crossings = [
        crossing
        for i in range(1, samples.size)
        for crossing in crossings_between(
            planned.best, float(samples[i - 1]), float(samples[i])
        )
    ]  # fmt: skip
    return _assemble(planned, samples, values, crossings)


def crossings_between(best: Best, low: float, high: float) -> list[MassCrossing]:
    """Return where the best joint changes between two masses.

    Args:
        best: returns the value of every joint at a mass.
        low: kg, the one.
        high: kg, the other.
    """
    at_low, at_high = best(low), best(high)
    before, after = _winner(at_low), _winner(at_high)
    if before == after:
        return []
    mass = _equal(lambda m: best(m)[before] - best(m)[after], low, high)
    third = _winner(best(mass))
    margin = best(mass)[third] - best(mass)[before]
    if third in (before, after) or margin <= EXACT * best(mass)[third]:
        return [MassCrossing(mass, before, after)]
    return [*crossings_between(best, low, mass), *crossings_between(best, mass, high)]


def _equal(gap: Callable[[float], float], low: float, high: float) -> float:
    """Return where a gap that is positive at `low` and not at `high` vanishes (Illinois)."""
    at_low, at_high, side = gap(low), gap(high), 0
    for _ in range(MOST_STEPS):
        if high - low <= EXACT * high or at_high == 0:
            break
        middle = (low * at_high - high * at_low) / (at_high - at_low)
        # A step short of the bracket's end closes it where false position creeps.
        least = EXACT * high / 4
        middle = min(max(middle, low + least), high - least)
        at_middle = gap(middle)
        if at_middle > 0:
            low, at_low, at_high, side = middle, at_middle, at_high / (1 + (side == 1)), 1
        else:
            high, at_high, at_low, side = middle, at_middle, at_low / (1 + (side == -1)), -1
    return high


def _winner(values: dict[int, float]) -> int:
    return max(values, key=lambda joint: values[joint])


class _Planned:
    """The best hits of every joint, planned once for each mass."""

    def __init__(
        self,
        robot: Robot,
        position: ArrayLike,
        direction: ArrayLike,
        contacts: tuple[Contact, ...],
        objective: str,
        away: bool,
        seed: int,
    ) -> None:
        self.robot, self.contacts, self.seed = robot, contacts, seed
        self.position, self.direction = position, direction
        self.objective, self.away = objective, away
        self.able: tuple[Contact, ...] = contacts
        self.plans: dict[float, dict[int, Any]] = {}

    def best(self, mass: float) -> dict[int, float]:
        """Return the value of every joint that can hit, by joint.

        Raises:
            InfeasibleError: none can.
        """
        name = OBJECTIVES[self.objective]
        return {joint: getattr(one, name) for joint, one in self.candidates(mass).items()}

    def candidates(self, mass: float) -> dict[int, Any]:
        """Return the candidates of the joints that can hit; what cannot does so for no mass."""
        if mass not in self.plans:
            planned = plan(
                self.robot,
                self.position,
                self.direction,
                mass,
                joints=self.able,
                objective=self.objective,
                away=self.away,
                seed=self.seed,
                certificate=False,
            )
            found = {one.joint: one for one in planned.candidates if one.feasible}
            if not found:
                reasons = "; ".join(str(one.reason) for one in planned.candidates)
                raise InfeasibleError(f"no joint can do it: {reasons}")
            self.able = tuple(contact for contact in self.able if contact.joint in found)
            self.plans[mass] = found
        return self.plans[mass]


def _assemble(
    planned: _Planned,
    masses: Any,
    values: list[dict[int, float]],
    crossings: list[MassCrossing],
) -> Dataset:
    import xarray as xr

    joints = [contact.joint for contact in planned.contacts]
    n, shape = planned.robot.n, (len(joints), masses.size)
    value = OBJECTIVES[planned.objective]
    pace = "speed" if value == "flux" else "straight_speed"
    columns = {name: np.full(shape, np.nan) for name in (value, "inertia", pace)}
    q = np.full((*shape, n), np.nan)
    for i, mass in enumerate(masses):
        for joint, one in planned.candidates(float(mass)).items():
            row = joints.index(joint)
            q[row, i] = one.q
            for name, column in columns.items():
                column[row, i] = getattr(one, name)
    over = ("joint", "mass")
    variables: dict[str, Any] = {name: (over, column) for name, column in columns.items()}
    variables |= {"q": ((*over, "axis"), q), "best": ("mass", [_winner(v) for v in values])}
    if crossings:
        variables |= {
            f"crossing_{name}": ("crossing", [getattr(one, name) for one in crossings])
            for name in MassCrossing._fields
        }
    dataset = xr.Dataset(
        variables, coords={"joint": joints, "mass": masses, "axis": np.arange(1, n + 1)}
    )
    return described(
        dataset,
        planned.robot,
        position=np.asarray(planned.position, dtype=float).tolist(),
        direction=np.asarray(planned.direction, dtype=float).tolist(),
        objective=planned.objective,
        away=planned.away,
        seed=planned.seed,
    )
