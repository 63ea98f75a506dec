"""Show an arm, or a plan, in the browser."""

from __future__ import annotations

import socket
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError
from hitjoints.first_argument import by_first_argument
from hitjoints.hit import Hit
from hitjoints.planning.plan_record import Plan
from hitjoints.show.viewer import Viewer

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Contact, Robot


@by_first_argument
def view(  # noqa: PLR0913
    robot: Robot,
    q: ArrayLike | None = None,
    contact: Contact | int | None = None,
    *,
    position: ArrayLike = (0.5, 0.3, 0.5),
    direction: ArrayLike = (0.0, 1.0, 0.0),
    mass: float = 2.0,
    flux: float = 0.3,
    q_hit: ArrayLike | None = None,
    host: str = "127.0.0.1",
    port: int = 8080,
) -> Viewer:
    """Show an arm in the browser, with the inertia felt at a contact, and let it plan and hit.

    Args:
        robot: the arm.
        q: (n,) rad, the configuration to begin with; home by default.
        contact: joint number or Contact; the last but one of the hitting joints by default.
        position: the hit, see `Hit`; all but the offset of the contact can be changed in the
            browser.
        direction: the hit, see `Hit`; all but the offset of the contact can be changed in the
            browser.
        mass: the hit, see `Hit`; all but the offset of the contact can be changed in the browser.
        flux: the hit, see `Hit`; all but the offset of the contact can be changed in the browser.
        q_hit: (n,) rad, the configuration that the hit is played to; planned when not given.
        host: where to serve; the next free port if this one is taken.
        port: where to serve; the next free port if this one is taken.

    Returns:
        A `Viewer`, which serves in threads of its own until `stop` or the end of the program.

    Raises:
        InputError: an argument cannot be used.
        MissingExtraError: viser is not installed.
        ModelError: a collision shape cannot be drawn.
    """
    chosen = robot.contact(robot.usual_joint if contact is None else contact)
    hit = Hit(chosen, np.asarray(position), np.asarray(direction), mass, flux)
    if not 0 < port < 65536:
        raise InputError("port", port, "a port is from 1 to 65535")
    _check_address(host)
    viewer = Viewer(robot, hit, robot.within_limits(robot.home if q is None else q), host, port)
    if q_hit is not None:
        viewer.remember(hit, robot.within_limits(q_hit, "q_hit"))
    return viewer


@view.register(Plan)
def _view_plan(
    planned: Plan, robot: Robot | None = None, *, host: str = "127.0.0.1", port: int = 8080
) -> Viewer:
    """Show a plan: its hit, in its configuration, which a hit is played to.

    Args:
        planned: a plan that says yes.
        robot: the arm, if it is loaded already.
        host: where to serve.
        port: where to serve; the next free one if it is taken.
    """
    arm, hit, told = planned.carried_out(robot)
    where: dict[str, Any] = {"position": hit.position, "direction": hit.direction, "mass": hit.mass}
    flux: dict[str, Any] = {} if hit.flux is None else {"flux": hit.flux}
    q = told["q_hit"]
    return view(arm, q, hit.contact, **where, **flux, q_hit=q, host=host, port=port)


def _check_address(host: str) -> None:
    """Refuse an address that is not this machine's: viser would wait for ever."""
    try:
        with socket.socket() as probe:
            probe.bind((host, 0))
    except OSError as error:
        raise InputError("host", host, f"it cannot be served on ({error.strerror})") from None
