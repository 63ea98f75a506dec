"""The paper's experiments on three readings of its arm, with every number it prints."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, replace
from itertools import product
from typing import TYPE_CHECKING, Any

from hitjoints.counting import counted
from hitjoints.errors import InputError, UnknownNameError
from hitjoints.evidence.paper import claims, desired_inertia, hits, joint_turn, spread
from hitjoints.evidence.paper.claim_rows import ClaimRow, Item, Values, rows_of
from hitjoints.evidence.paper.scenario import Scenario
from hitjoints.evidence.paper.variants import VARIANTS, variant
from hitjoints.told import Told, brief

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.evidence.paper.desired_inertia import References
    from hitjoints.evidence.paper.hits import Hits
    from hitjoints.evidence.paper.spread import Spread
    from hitjoints.model.robot import Robot

PARTS = ("fig2", "fig4", "fig6", "text")
CHOICES = ("fig2", "fig4", "fig6", "all")
LINES: Mapping[str, tuple[Item, ...]] = {
    "fig2": joint_turn.LINES,
    "fig4": desired_inertia.LINES,
    "fig6": hits.LINES + spread.LINES,
    "text": claims.LINES,
}
LEAST_SETUPS = 500
"""Fewer start positions leave too few usable setups for percentiles."""


@dataclass(eq=False)
class Experiments:
    """What was run on one arm, as far as it was asked for."""

    robot: Robot
    turn: Dataset | None = None
    references: References | None = None
    hits: Hits | None = None
    spread: Spread | None = None


@dataclass(frozen=True, eq=False, repr=False)
class Reproduction(Told):
    """The paper's numbers beside ours.

    Attributes:
        figure: what was asked for.
        scenario: what the paper does not print, and what was taken for it.
        rows: the table.
        experiments: by the names of `VARIANTS`.
    """

    figure: str
    scenario: Scenario
    rows: tuple[ClaimRow, ...]
    experiments: Mapping[str, Experiments] = field(repr=False)

    @property
    def words(self) -> str:
        """What was run, in a line."""
        return f"{self.figure}: {len(self.rows)} numbers of the paper beside ours"

    def lines(self) -> list[tuple[str, object]]:
        """Return the paper's numbers and ours."""
        said = [row.as_dict() for row in self.rows]
        return [
            (f"{row['figure']}, {row['quantity']}", f"{row['paper']}: {brief(row['iiwa14'])}")
            for row in said
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return the table and the scenario as JSON knows them."""
        return {
            "figure": self.figure,
            "scenario": asdict(self.scenario),
            "rows": [row.as_dict() for row in self.rows],
        }


def reproduce(
    figure: str = "all",
    *,
    setups: int | None = None,
) -> Reproduction:
    """Repeat the paper's experiments and put its numbers beside ours.

    On `iiwa14_bullet`, whose inertia tensors are those of the paper's simulation, on `iiwa14`, and
    on an iiwa 14 with the phantom inertia of a common description of it. Same input, same output.

    Args:
        figure: "fig2", "fig4", "fig6" (with Fig. 5 and the spread over random setups), or "all"
            (with what the text says besides).
        setups: start positions tried for the spread, at least 500; 12000 when not given.

    Returns:
        The table as `rows`, and what the figures are drawn from.

    Raises:
        InputError: there is no such figure, or too few setups.
    """
    if figure not in CHOICES:
        raise UnknownNameError("figure", figure, CHOICES)
    scenario = Scenario() if setups is None else replace(Scenario(), setups=setups)
    if not isinstance(scenario.setups, int) or scenario.setups < LEAST_SETUPS:
        raise InputError("setups", setups, f"at least {LEAST_SETUPS} start positions")
    parts = PARTS if figure == "all" else (figure,)
    experiments = {name: Experiments(variant(name)) for name in VARIANTS}
    rows: list[ClaimRow] = []
    values: dict[str, dict[str, Values]] = {part: {} for part in parts}
    for part, name in counted(list(product(parts, VARIANTS)), "experiments"):
        values[part][name] = _run(part, experiments[name], scenario)
    for part in parts:
        rows += rows_of(LINES[part], values[part])
    return Reproduction(figure, scenario, tuple(rows), experiments)


def _run(part: str, on: Experiments, scenario: Scenario) -> Values:
    """Run a part on one arm, keep what is drawn, and return the values of its lines."""
    robot = on.robot
    if part == "fig2":
        on.turn = joint_turn.turn_joints(robot, scenario)
        return joint_turn.turn_values(robot, scenario, on.turn)
    if part == "fig4":
        on.references = desired_inertia.follow_references(robot, scenario)
        return desired_inertia.reference_values(robot, scenario, on.references)
    if part == "fig6":
        on.hits = hits.hit_with_joints(robot, scenario)
        on.spread = spread.study_spread(robot, scenario)
        return {
            **hits.hit_values(robot, scenario, on.hits),
            **spread.spread_values(on.spread),
        }
    return claims.claim_values(robot, scenario)
