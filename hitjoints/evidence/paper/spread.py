"""Which kilograms come out for other start positions: the paper does not print its own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.evidence.paper.claim_rows import Item, Values
from hitjoints.evidence.paper.many import along_the_line, best_postures
from hitjoints.evidence.paper.scenario import PRINTED, PRINTED_MORE
from hitjoints.model.robot import Contact
from hitjoints.quantities import place_joint

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

NEAR = 0.1
"""Share of a printed number that counts as near it."""


@dataclass(frozen=True, eq=False)
class Spread:
    """Inertia at the impact over random setups: the same start and object for both joints.

    Attributes:
        tried: start positions drawn.
        start: (N, 3) m, of the setups in which both joints hit.
        inertia: joint -> (N,) kg, at the impact.
        angle: (N,) deg, between the last link (joint 6 to 7) and the direction at joint 7's impact.
        eq14: joint -> kg, inertia by Eq. 14 at the scenario's own start, one value per inverse
            kinematics solution.
    """

    tried: int
    start: Array
    inertia: dict[int, Array]
    angle: Array
    eq14: dict[int, Array]

    @property
    def more(self) -> Array:
        """(N,) %, by how much joint 6 has more than joint 7."""
        return (self.inertia[6] / self.inertia[7] - 1) * 100


def study_spread(robot: Robot, scenario: Scenario) -> Spread:
    """Hit from random start positions around the arm, with a random arm posture at each.

    At a start position the joint is placed by inverse kinematics from a random configuration, the
    joints beyond it by Eq. 14; it then moves along the line to the object. A setup counts when both
    joints get there within the position limits and can deliver the flux there.
    """
    rng = np.random.default_rng(scenario.seed)
    start = rng.uniform(scenario.low, scenario.high, (scenario.setups, 3))
    usable = np.ones(scenario.setups, dtype=bool)
    inertia, angle = {}, {}
    for k in PRINTED:
        at, inertia[k], angle[k] = _hits(robot, k, start, scenario)
        usable &= at
    repeated = np.tile(scenario.start, (scenario.samples, 1))
    eq14 = {}
    for k in PRINTED:
        placed = place_joint(robot, k, repeated, scenario.seed)
        found = best_postures(robot, placed.q[placed.solved], k, scenario.h)[1]
        eq14[k] = found[np.isfinite(found)]
    kept = {k: values[usable] for k, values in inertia.items()}
    return Spread(scenario.setups, start[usable], kept, angle[7][usable], eq14)


def _hits(
    robot: Robot, joint: int, start: Array, scenario: Scenario
) -> tuple[NDArray[np.bool_], Array, Array]:
    """Return whether joint k hits from each start (N,), its inertia (N,) kg and its angle there.

    The angle (N,) deg is that between the direction and the link from joint k - 1 to joint k.
    """
    h, hit = scenario.h, np.zeros(len(start), dtype=bool)
    placed = place_joint(robot, joint, start, scenario.seed + joint)
    rows = np.flatnonzero(placed.solved)
    q, found = best_postures(robot, placed.q[rows], joint, h)
    rows, q = rows[np.isfinite(found)], q[np.isfinite(found)]
    q, arrived = along_the_line(robot, q, joint, h, scenario.run_up)
    ends = Contact(joint), Contact(joint - 1)
    values = kernel_for(robot, ends, ("inertia", "straight_flux", "position"))(q, h, scenario.mass)
    inertia, angle = np.full((2, len(start)), np.nan)
    inertia[rows] = values["inertia"][0]
    angle[rows] = angle_to(values["position"][0] - values["position"][1], h)
    hit[rows] = arrived & (values["straight_flux"][0] >= scenario.flux)
    return hit, inertia, angle


def angle_to(link: Array, h: Array) -> Array:
    """Return the angle (deg), 0 to 90, between the lines along links (..., 3) and h (3,)."""
    along = np.abs(link @ h) / np.linalg.norm(link, axis=-1)
    return np.asarray(np.degrees(np.arccos(np.minimum(along, 1.0))))


def spread_values(spread: Spread) -> Values:
    """Return the values of `LINES` on one arm."""
    values: dict[str, float | int | str | None] = {
        "setups": len(spread.start),
        "tried": spread.tried,
    }
    near = np.ones(len(spread.start), dtype=bool)
    for k, printed in PRINTED.items():
        found = spread.inertia[k]
        values |= _summary(f"inertia_{k}", found, printed)
        near_one = np.abs(found / printed - 1) <= NEAR
        near &= near_one
        if k == 7:
            values["angle_near_7"] = (
                float(np.median(spread.angle[near_one])) if near_one.any() else None
            )
        values[f"eq14_least_{k}"] = float(spread.eq14[k].min())
        values[f"eq14_greatest_{k}"] = float(spread.eq14[k].max())
    values |= _summary("more", spread.more, PRINTED_MORE)
    values["angle_median_7"] = float(np.median(spread.angle))
    values["near_both"] = float(near.mean()) * 100
    values["less"] = float((spread.more < 0).mean()) * 100
    return values


def _summary(name: str, found: Array, printed: float) -> Values:
    low, middle, high = np.percentile(found, (5, 50, 95))
    return {
        f"{name}_low": float(low),
        f"{name}_median": float(middle),
        f"{name}_high": float(high),
        f"{name}_below": float((found < printed).mean()) * 100,
    }


LINES = (
    Item("setups", "spread", "random setups in which joints 7 and 6 both hit", None,
         "Of {bullet[tried]} start positions around the arm: the same start and object for both "
         "joints, random arm postures, Eq. 14, within the limits, the flux within reach."),
    *(
        Item(f"inertia_{k}_{end}", "spread", f"joint {k}: inertia at the impact, {what} (kg)",
             PRINTED[k] if end == "median" else None, remark)
        for k in PRINTED
        for end, what, remark in (
            ("low", "5 % of setups have less", "The printed number is one setup's."),
            ("median", "median of setups", "The printed number is one setup's."),
            ("high", "5 % of setups have more", "The printed number is one setup's."),
        )
    ),
    Item("inertia_7_below", "spread", "joint 7: setups with less than the printed 2.5 kg (%)", None,
         "2.5 kg is a heavy posture of joint 7, but within the range; with the phantom it is "
         "beyond it."),
    Item("inertia_6_below", "spread", "joint 6: setups with less than the printed 3.9 kg (%)", None,
         "3.9 kg is about what one has to expect."),
    Item("angle_median_7", "spread", "joint 7: angle of its last link to the direction at the "
         "impact, median of setups (deg)", None, "The less the last link lies along the direction, "
         "the more the wrist alone moves joint 7 along it, and the lighter it feels."),
    Item("angle_near_7", "spread", "the same, of setups within 10 % of the printed 2.5 kg (deg)",
         None, "The paper's hand probably lay more along the direction than most, and than ours."),
    Item("more_low", "spread", "joint 6 more than joint 7, 5 % of setups have less (%)", None,
         "The range of the setups."),
    Item("more_median", "spread", "joint 6 more than joint 7, median of setups (%)", 56.0,
         "The printed number is one setup's; the advantage of joint 6 is usually greater."),
    Item("more_high", "spread", "joint 6 more than joint 7, 5 % of setups have more (%)", None,
         "The range of the setups."),
    Item("more_below", "spread", "joint 6 more than joint 7: setups below the printed 56 % (%)",
         None, "56 % is within the range, on its low side."),
    Item("less", "spread", "setups in which joint 6 has less inertia than joint 7 (%)", None,
         "The paper's finding, joint 6 heavier than joint 7, is the rule. With the phantom it "
         "would fail in a quarter of the setups."),
    Item("near_both", "spread", "setups in which both kilograms are within 10 % of the printed (%)",
         None, "The printed pair can occur on these tensors; it cannot with the phantom."),
    *(
        Item(f"eq14_{end}_{k}", "spread", f"joint {k}: {end} inertia by Eq. 14 at the start of "
             "fig5, over arm postures (kg)", "quite sensitive",
             "As stated: what Eq. 14 finds depends on the posture of the joints before k, which "
             "inverse kinematics leaves open.")
        for k in PRINTED
        for end in ("least", "greatest")
    ),
)  # fmt: skip
