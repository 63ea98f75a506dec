"""What torque limits cost: the flux that the controller reaches with and without them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import jacobian, position
from hitjoints.hit import Hit
from hitjoints.impact.flux import flux
from hitjoints.planning.acceleration import run_from
from hitjoints.planning.start import SETTLED, SHARES, plan_start
from hitjoints.programs.hitting_speed import solve_hitting_speed
from hitjoints.vectors import unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot

LONGER = 2.0
"""Factor from the run-up that the field needs to the second that is tried."""
STRAIGHT = 2.0
"""deg, how far from the direction a contact may move at the impact."""


@dataclass(frozen=True)
class TorqueCost:
    """The greatest flux of a joint at a configuration, and what is left of it in motion.

    Attributes:
        joint: the hitting joint.
        straight_flux: m/s, the most that velocity limits allow at the hitting configuration.
        flux_without: m/s, the most that the controller reaches from rest after a run-up, without
            and with torque limits; None if none of the starts tried is a hit.
        flux_with: m/s, the most that the controller reaches from rest after a run-up, without and
            with torque limits; None if none of the starts tried is a hit.
    """

    joint: int
    straight_flux: float
    flux_without: float | None
    flux_with: float | None

    def as_dict(self) -> dict[str, Any]:
        """Return the attributes by name."""
        return dict(vars(self))


def torque_cost(
    robot: Robot, q: ArrayLike, contact: Contact | int, direction: ArrayLike, mass: float
) -> TorqueCost:
    """Find what torque limits cost a hit, by running it.

    Shares of the straight flux are asked for from starts one and two settling lengths behind the
    object; what arrives at the impact counts, saturated or not, within 2 mm and 2 degrees.

    Args:
        robot: the arm, with effort limits.
        q: (n,) rad, the hitting configuration, within the limits.
        contact: joint number or Contact.
        direction: (3,), the hitting direction.
        mass: kg, of the object.

    Raises:
        InputError: an argument cannot be used, or the robot has no effort limits.
        InfeasibleError: the contact cannot move along the direction.
    """
    contact, q, h = robot.contact(contact), robot.within_limits(q), unit(direction)
    target, inertia = position(robot, q, contact), inertia_along(robot, q, contact, h)
    limits = robot.velocity_lower, robot.velocity_upper
    top = solve_hitting_speed(jacobian(robot, q, contact), h, *limits, straight=True).speed
    most = flux(1.0 / inertia, mass, top)
    reached: dict[bool, float] = {}
    for share in SHARES:
        if share * most <= min(reached.get(limited, 0.0) for limited in (False, True)):
            break
        run_up = None
        for _ in range(2):
            start = plan_start(robot, q, contact, h, share * top, run_up=run_up)
            if not start.feasible:
                break
            run_up = LONGER * start.run_up
            hit = Hit(contact, target.round(9), h, mass, share * most)
            for limited in (False, True):
                run, why = run_from(robot, hit, start.q, {"torque_limits": limited})
                struck = None if run is None or why else run.impact
                if struck and struck.miss <= SETTLED and struck.direction_error <= STRAIGHT:
                    reached[limited] = max(reached.get(limited, 0.0), struck.flux)
    return TorqueCost(contact.joint, most, reached.get(False), reached.get(True))
