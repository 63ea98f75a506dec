"""Fig. 4: desired and achieved inertia, with a constant reference and with Eq. 13's."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.inertia import inertia_and_gradient_along
from hitjoints.evidence.paper.claim_rows import Item, Value, Values
from hitjoints.evidence.paper.starts import hit_from, paper_start
from hitjoints.hitting.controller import ReferenceName
from hitjoints.model.robot import Contact

if TYPE_CHECKING:
    from hitjoints.evidence.paper.scenario import Scenario
    from hitjoints.model.robot import Robot
    from hitjoints.rollouts.record import Rollout
    from hitjoints.types import Array

REFERENCES: tuple[ReferenceName, ReferenceName] = ("constant", "optimised")
FOLLOWED = (7, 6)
"""Joints whose inertia is followed: the end effector, of which Eq. 7 speaks, and joint 6."""

References = Mapping[tuple[int, str], "Rollout"]


def follow_references(robot: Robot, scenario: Scenario) -> References:
    """Return the hits of joints 7 and 6 by (joint, reference), by Eq. 5-7 and 12-13 as printed."""
    starts = {k: paper_start(robot, k, scenario) for k in FOLLOWED}
    return {
        (k, reference): hit_from(robot, starts[k], scenario, reference=reference)
        for k in FOLLOWED
        for reference in REFERENCES
    }


def reference_values(robot: Robot, scenario: Scenario, hits: References) -> Values:
    """Return the values of `LINES` on one arm."""
    values: dict[str, Value] = {"flux": scenario.flux}
    for k in FOLLOWED:
        for reference in REFERENCES:
            rows = hits[k, reference].rows
            error = (rows["inertia"] - rows["desired_inertia"])[rows["approach"]]
            values[f"rms_{reference}_{k}"] = _rms(error)
            impact = hits[k, reference].impact
            values[f"flux_{reference}_{k}"] = None if impact is None else impact.flux
        values[f"apart_{k}"] = _rms(np.subtract(*(_along(hits[k, r]) for r in REFERENCES)))
    start = hits[7, "optimised"].rows["q"][0]
    gradient = inertia_and_gradient_along(robot, start, Contact(7), scenario.h)[1]
    values["gradient_least"], values["residuals"] = float(gradient.min()), 3
    return values


def _along(hit: Rollout) -> Array:
    """Return the inertia at evenly spaced points of the way, kg."""
    rows, asked = hit.rows, hit.hit
    way = (rows["position"] - asked.position) @ asked.direction
    return np.interp(np.linspace(way[0], 0.0, 101), way, rows["inertia"])


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


LINES = (
    Item("rms_constant_7", "fig4", "joint 7, constant reference: RMS of inertia - desired (kg)",
         None, "Only curves are printed, not for which joint. The constant is the inertia of the "
         "configuration that inverse kinematics finds at the object, which lies close to the "
         "motion here; elsewhere it may be kilograms away."),
    Item("rms_optimised_7", "fig4", "joint 7, reference of Eq. 13: RMS of inertia - desired (kg)",
         None, "As the figure shows: Eq. 13 is one step ahead of where the arm is, so it is always "
         "within reach."),
    Item("rms_constant_6", "fig4", "joint 6, constant reference: RMS of inertia - desired (kg)",
         None, "Here the inertia grows by 0.6 kg along the way, and the constant does not know."),
    Item("rms_optimised_6", "fig4", "joint 6, reference of Eq. 13: RMS of inertia - desired (kg)",
         None, "As for joint 7."),
    Item("apart_7", "fig4", "joint 7: RMS between the two motions' inertia (kg)", "almost the same",
         "As stated: the reference hardly changes what the arm does, since the inertia term of "
         "Eq. 7 has only the null space."),
    Item("apart_6", "fig4", "joint 6: RMS between the two motions' inertia (kg)", "almost the same",
         "As stated."),
    Item("flux", "fig4", "desired flux (m/s)", None, "Not printed; the default of "
         "`hitjoints rollout`."),
    Item("flux_constant_7", "fig4", "joint 7, constant reference: flux at the impact (m/s)", None,
         "Eq. 5 as printed slows down beside its line, by 3 % at a third of a millimetre. With "
         "--speed-profile constant the flux is the desired one."),
    Item("flux_optimised_7", "fig4", "joint 7, reference of Eq. 13: flux at the impact (m/s)", None,
         "The same."),
    Item("residuals", "fig4", "Eq. 12: entries of the residual that W weighs", 7,
         "Erratum: J qd - f has 3 entries, W = I_7 does not fit it. hitjoints weighs the joint "
         "motion with it, see rollout."),
    Item("gradient_least", "fig4", "Eq. 12: least entry of W = diag(grad lambda) (kg/rad)", None,
         "Erratum: with a weight below zero the problem is not convex. hitjoints takes "
         "|grad lambda| / max + 0.1."),
)  # fmt: skip
