"""Fig. 5-6: the same start position, object and flux, hit with joints 7, 6 and 5."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.inertia import inverse_inertia
from hitjoints.dynamics.kinematics import position
from hitjoints.evidence.paper.claim_rows import Item, Value, Values
from hitjoints.evidence.paper.scenario import JOINTS, PRINTED
from hitjoints.evidence.paper.spread import angle_to
from hitjoints.evidence.paper.starts import PaperStart, hit_from, paper_start
from hitjoints.impact.collision import hitting_flux
from hitjoints.quantities import hitting_speed

if TYPE_CHECKING:
    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.hitting.approach import Impact
    from hitjoints.model.robot import Robot
    from hitjoints.rollouts.record import Rollout


@dataclass(frozen=True, eq=False)
class Hits:
    """The hits of one arm, by joint.

    Attributes:
        starts: by Eq. 14.
        printed: rolled out by Eq. 7 as printed.
        qp: by the default law of hitjoints.
    """

    starts: Mapping[int, PaperStart]
    printed: Mapping[int, Rollout]
    qp: Mapping[int, Rollout]

    def shown(self, joint: int) -> Rollout:
        """Return the hit as printed, or, if that does not arrive, the default law's."""
        printed = self.printed[joint]
        return self.qp[joint] if printed.reason else printed


def hit_with_joints(robot: Robot, scenario: Scenario) -> Hits:
    """Start joints 7, 6 and 5 by Eq. 14 and roll the hits out."""
    starts = {k: paper_start(robot, k, scenario) for k in JOINTS}
    rolled = [
        {k: hit_from(robot, starts[k], scenario, law=law) for k in JOINTS}
        for law in ("paper", "qp")
    ]
    return Hits(starts, *rolled)


def hit_values(robot: Robot, scenario: Scenario, hits: Hits) -> Values:
    """Return the values of `LINES` on one arm."""
    values: dict[str, Value] = {"wanted": scenario.flux}
    inertia: dict[int, float] = {}
    held: dict[int, float] = {}
    places = np.stack([position(robot, hits.starts[k].posture.q, k) for k in JOINTS])
    values["start_apart"] = float(np.abs(places - scenario.start).max()) * 1e3
    for k in JOINTS:
        start, impact = hits.starts[k], hits.shown(k).impact
        assert impact is not None
        values[f"placed_{k}"], values[f"start_{k}"] = start.placed_inertia, start.posture.inertia
        values[f"away_{k}"] = start.posture.away_gap * 1e3
        values[f"flux_{k}"] = impact.flux
        held[k] = values[f"held_{k}"] = _held(robot, k, impact, scenario)
        inertia[k] = values[f"impact_{k}"] = impact.inertia
        values[f"most_{k}"] = hitting_flux(
            impact.inertia,
            scenario.mass,
            hitting_speed(robot, impact.q, k, scenario.direction, straight=True),
        )
        other = hits.qp[k].impact
        assert other is not None
        values[f"qp_{k}"] = other.inertia
    struck = hits.shown(7).impact
    assert struck is not None
    last_link = position(robot, struck.q, 7) - position(robot, struck.q, 6)
    values["angle_7"] = float(angle_to(last_link, scenario.h))
    seven, six = inertia[7], inertia[6]
    values["more"], values["more_if"] = (six / seven - 1) * 100, (six / PRINTED[7] - 1) * 100
    values["printed_more"] = (PRINTED[6] / PRINTED[7] - 1) * 100
    values["off_6"] = abs(six / PRINTED[6] - 1) * 100
    values["rebound"], values["printed_rebound"] = seven / six, PRINTED[7] / PRINTED[6]
    values["held_more"] = (held[6] / held[7] - 1) * 100
    printed = hits.printed[5]
    values["stalled_5"] = printed.reason.partition(" ")[0] or "arrives"
    return values


def _held(robot: Robot, joint: int, impact: Impact, scenario: Scenario) -> float:
    """Return h^T Lambda h (kg): the inertia of a contact that is held from moving sideways."""
    inverse = inverse_inertia(robot, impact.q, joint)
    return float(scenario.h @ np.linalg.solve(inverse, scenario.h))


LINES = (
    Item("start_apart", "fig5", "distance of the joints' starts from one position (mm)", "the same",
         "As stated."),
    Item("start_7", "fig5", "joint 7: inertia at the start, Eq. 14 (kg)", None,
         "Flat: {bullet[placed_7]:.4g} kg before Eq. 14, which only turns joint 7."),
    Item("start_6", "fig5", "joint 6: inertia at the start, Eq. 14 (kg)", None,
         "{bullet[placed_6]:.3g} kg before Eq. 14. With the phantom Eq. 14 would double it, "
         "from {phantom[placed_6]:.3g} kg: it optimises an inertia that is not there."),
    Item("start_5", "fig5", "joint 5: inertia at the start, Eq. 14 (kg)", None,
         "{bullet[placed_5]:.3g} kg before Eq. 14."),
    *(
        Item(f"away_{k}", "fig5", f"joint {k}: h . (chi_{k + 1} - chi_{k}) (mm)", "< 0", remark)
        for k, remark in (
            (7, "Met; chi_8 is the flange. q_7 has no influence on it."),
            (6, "Met."),
            (5, "Met. q_5 has no influence on it."),
        )
    ),
    Item("impact_7", "fig6", "joint 7: inertia at the impact (kg)", 2.5,
         "Differs: the paper prints neither the object's place nor the start, on which it depends: "
         "{bullet[inertia_7_below]:.0f} % of random setups have less than 2.5 kg, and at this very "
         "start Eq. 14 gives {bullet[eq14_least_7]:.2g} to {bullet[eq14_greatest_7]:.2g} kg, "
         "depending on the posture of the arm. What matters is how far the last link lies along "
         "the direction, see below. PyBullet's tensors add {tensors[impact_7]:.0f} %. "
         "With the phantom {phantom[inertia_7_below]:.0f} % of setups have less than 2.5 kg, so "
         "the paper's arm seems to have had none."),
    Item("angle_7", "fig6", "joint 7: angle of its last link to the direction at the impact (deg)",
         None, "Across the direction the wrist alone moves joint 7, and it feels light. Setups "
         "near 2.5 kg have {bullet[angle_near_7]:.0f} deg in the median."),
    Item("impact_6", "fig6", "joint 6: inertia at the impact (kg)", 3.9,
         "Agrees to {bullet[off_6]:.0f} %, which is luck: {bullet[inertia_6_low]:.2g} to "
         "{bullet[inertia_6_high]:.2g} kg (5 to 95 %) come out of random setups. PyBullet's "
         "tensors change it by {tensors[impact_6]:.1f} %."),
    Item("impact_5", "fig6", "joint 5: inertia at the impact (kg)", None,
         "The paper's Fig. 6 leaves joint 5 out. It cannot have the same flux here, see below."),
    Item("more", "fig6", "joint 6 more than joint 7 (%)", 56.0,
         "Does not come out, because joint 7 is lighter here: with 2.5 kg it would be "
         "{bullet[more_if]:.0f} %. What does: joint 6 is heavier. Random setups have "
         "{bullet[more_median]:.0f} % in the median, {bullet[more_below]:.0f} % of them less than "
         "56 %."),
    Item("printed_more", "fig6", "the same, from the printed kilograms (%)", 56.0,
         "3.9 / 2.5: the three printed numbers agree with each other."),
    Item("flux_7", "fig6", "joint 7: flux at the impact (m/s)", None,
         "{bullet[wanted]:g} m/s is asked of every joint. The field as printed slows down beside "
         "its line, see fig4."),
    Item("flux_6", "fig6", "joint 6: flux at the impact (m/s)", "the same",
         "As stated."),
    Item("flux_5", "fig6", "joint 5: flux at the impact (m/s)", "the same",
         "Differs: joint 5 gives {bullet[most_5]:.2g} m/s at most when it moves straight along the "
         "direction at the object, a quarter of what is asked."),
    Item("stalled_5", "fig6", "joint 5: the motion by Eq. 7 as printed", None,
         "The optimum of Eq. 14 has q_5 at its limit; the null space term pushes it on, and "
         "scaling all joints by one factor stops the arm. The default law (--law qp) arrives; "
         "joint 5's other numbers are its."),
    Item("qp_7", "fig6", "joint 7: inertia at the impact, --law qp (kg)", None,
         "The default law gives what Eq. 7 gives where no limit is in the way."),
    Item("qp_6", "fig6", "joint 6: inertia at the impact, --law qp (kg)", None, "The same."),
    Item("held_7", "fig6", "joint 7: h^T Lambda h at the impact (kg)", None,
         "What the authors' code computes in place of 1 / (h^T Lambda^-1 h): the inertia if the "
         "contact were held from moving sideways. It is nearer to the paper's 2.5 kg."),
    Item("held_6", "fig6", "joint 6: h^T Lambda h at the impact (kg)", None,
         "It is further from the paper's 3.9 kg, and joint 6 would have {bullet[held_more]:.0f} % "
         "more than joint 7: this does not explain the difference."),
    Item("rebound", "fig6", "change of the robot's speed by the impact (Eq. 11), joint 6 / joint 7",
         "lower", "As stated in Section III-B: at the same flux it goes with 1 / lambda. The "
         "paper's kilograms give {bullet[printed_rebound]:.2g}."),
)  # fmt: skip
