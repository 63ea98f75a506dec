"""Fig. 2: inertia, speed and flux while the hitting joint turns (Section III-A)."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.evidence.paper.claim_rows import Item, Values
from hitjoints.evidence.paper.scenario import JOINTS, VELOCITIES, Scenario
from hitjoints.maps.joint_sweep import sweep_joint
from hitjoints.programs.hitting_speed import box_speed

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.model.robot import Robot

DEGREES = 180 / np.pi


def turn_joints(robot: Robot, scenario: Scenario) -> Dataset:
    """Return the sweep of Fig. 2, see `maps.joint_sweep.sweep_joint`."""
    return sweep_joint(
        robot, scenario.position, scenario.direction, scenario.mass, joints=sorted(JOINTS)
    )


def turn_values(robot: Robot, scenario: Scenario, sweep: Dataset) -> Values:
    """Return the values of `LINES` on one arm."""
    of = {k: sweep.sel(joint=k) for k in JOINTS}
    inertia = {k: float(np.median(of[k].inertia)) for k in JOINTS}
    speed = {k: float(of[k].speed.max()) for k in JOINTS}
    flux = {k: float(of[k].flux.max()) for k in JOINTS}
    values: dict[str, float | int | str | None] = {"mass": scenario.mass, "joints": robot.n}
    for k in JOINTS:
        values |= {f"inertia_{k}": inertia[k], f"speed_{k}": speed[k], f"flux_{k}": flux[k]}
        values[f"share_{k}"] = flux[k] / speed[k]
        values[f"swing_{k}"] = float(of[k].inertia.max() / of[k].inertia.min() - 1) * 100
    values["order"] = " > ".join(str(k) for k in sorted(JOINTS, key=lambda k: -flux[k]))
    values["six_to_seven"], values["five_to_seven"] = flux[6] / flux[7], flux[5] / flux[7]
    values["speed_change"] = max(float(np.ptp(of[k].speed.values)) for k in JOINTS)
    values["moved"] = max(_moved(robot, k, of[k]) for k in JOINTS)
    arms = np.stack([of[k].q.values[:4] for k in JOINTS])
    apart = np.ptp(arms, axis=0)
    values["apart"], values["apart_joint"] = float(apart.max()) * DEGREES, int(apart.argmax()) + 1
    pull = scenario.h @ jacobian(robot, of[6].q.values, 6)
    limit = np.array(VELOCITIES)
    values["authors_speed_6"] = box_speed(pull, -limit, limit)[0]
    values["printed_flux_6"] = (1 + scenario.mass / inertia[6]) * speed[6]
    return values


def _moved(robot: Robot, joint: int, row: Dataset) -> float:
    """Return how far joint k moves while it turns, mm."""
    places = []
    for angle in row.angle.values[:: max(1, row.angle.size // 8)]:
        q = np.array(row.q.values)
        q[joint - 1] = angle
        places.append(position(robot, q, joint))
    return float(np.ptp(places, axis=0).max()) * 1e3


CURVES = "Only curves are printed."
LINES = (
    Item("mass", "fig2", "mass of the object (kg)", 2.0, "As printed."),
    Item("joints", "fig2", "joints of the arm", 7, "As printed."),
    Item("inertia_7", "fig2", "joint 7: directional inertia, median over its turn (kg)", None,
         f"{CURVES} PyBullet's tensors add {{tensors[inertia_7]:.0f}} %; the phantom more than "
         "doubles it."),
    Item("inertia_6", "fig2", "joint 6: directional inertia, median over its turn (kg)", None,
         f"{CURVES} PyBullet's tensors add {{tensors[inertia_6]:.1f}} %."),
    Item("inertia_5", "fig2", "joint 5: directional inertia, median over its turn (kg)", None,
         f"{CURVES} PyBullet's tensors add {{tensors[inertia_5]:.1f}} %."),
    *(
        Item(f"speed_{k}", "fig2", f"joint {k}: maximum hitting speed, Eq. 9 (m/s)", None,
             f"{CURVES} Kinematics alone: the same on all arms.")
        for k in JOINTS
    ),
    *(
        Item(f"flux_{k}", "fig2", f"joint {k}: maximum hitting flux (m/s)", None, CURVES)
        for k in JOINTS
    ),
    Item("swing_7", "fig2", "joint 7: change of its inertia while it turns (%)", None,
         "Link 7 is symmetric about its axis, with PyBullet's tensors nearly so."),
    Item("swing_6", "fig2", "joint 6: change of its inertia while it turns (%)", None,
         "Links 6 and 7 weigh 2.1 kg together. With the phantom joint 6's turn seems to matter "
         "nine times as much."),
    Item("order", "fig2", "joints by their greatest flux", "6 > 7",
         "Joint 6 hits harder than joint 7, as printed, with PyBullet's and the URDF's tensors; "
         "the phantom reverses it. Where joint 5 comes depends on the tensors."),
    Item("six_to_seven", "fig2", "greatest flux, joint 6 / joint 7", "stronger",
         "As printed; not with the phantom."),
    Item("five_to_seven", "fig2", "greatest flux, joint 5 / joint 7", "relatively strong",
         "As printed, for free motion (Eq. 9). Straight along the direction joint 5 hardly moves "
         "here, see fig6."),
    *(
        Item(f"share_{k}", "fig2", f"joint {k}: share of the speed that becomes flux", None, remark)
        for k, remark in (
            (7, "An inertia like the object's mass leaves one half: the paper's remark that the "
             "flux is lower when they are of similar magnitude."),
            (6, "Twice the object's mass leaves two thirds."),
            (5, "Its inertia is nearly six times the object's mass."),
        )
    ),
    Item("speed_change", "fig2", "change of the maximum speed while joint k turns (m/s)",
         "constant", "As stated: the speed of joint k does not depend on the joints from k on."),
    Item("moved", "fig2", "motion of joint k while it turns (mm)", "constant", "As stated."),
    Item("apart", "fig2", "greatest difference of joints 1 to 4 between the configurations (deg)",
         "close", "Not so close, although from one common configuration, the robot's home: the "
         "joints lie up to 0.3 m apart along the arm, so putting each at the object takes this "
         "much of joint {bullet[apart_joint]}."),
    Item("authors_speed_6", "fig2", "joint 6: maximum speed with the authors' velocity limits "
         "(m/s)", None, "The authors' simulation cuts the data sheet's limits to 0.01 rad/s: "
         "{bullet[speed_6]:.4g} m/s with ours."),
    Item("printed_flux_6", "fig2", "joint 6: maximum flux by Eq. 10 as printed (m/s)", None,
         "Erratum: (1 + m/lambda) v contradicts Eq. 4 and gives more flux than speed. "
         "hitjoints has v / (1 + m/lambda): {bullet[flux_6]:.3g} m/s."),
)  # fmt: skip
