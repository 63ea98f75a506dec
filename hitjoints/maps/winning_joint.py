"""Which joint's hit shows most inertia, over the places of an object and contact times."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.built import kernel_for
from hitjoints.counting import counted
from hitjoints.datasets.describe import described
from hitjoints.impact.elastic import elastic_impact
from hitjoints.quantities import place_joint
from hitjoints.vectors import positive_mass, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array


def winning_joint(  # noqa: PLR0913
    robot: Robot,
    x: ArrayLike,
    y: ArrayLike,
    z: float,
    direction: ArrayLike,
    mass: float,
    times: Sequence[float] = (1e-3, 5e-3, 2e-2),
    *,
    restitution: float = 0.5,
    joints: Sequence[Contact | int] | None = None,
    samples: int = 60,
    stiffness: ArrayLike | None = None,
    rotor_inertia: ArrayLike | None = None,
    seed: int = 0,
) -> Dataset:
    """Map what each joint's hit shows, by the object's place and the contact time.

    Each joint hits in that of its samples of the self-motion which has the greatest straight flux
    of the links alone, at its greatest straight speed.

    Args:
        robot: the arm.
        x: (X,) m, places of the object.
        y: (Y,) m.
        z: m.
        direction: (3,), the hitting direction.
        mass: kg, of the object.
        times: (T,) s, contact times of the rigid pair.
        restitution: eps, from 0 to 1.
        joints: hitting joints or contacts; the robot's own when not given.
        samples: of each joint at each place.
        stiffness: of the joints, see `elastic_impact`.
        rotor_inertia: likewise.
        seed: of the samples.

    Returns:
        A data set over (joint, time, x, y): object_speed (m/s), equivalent (kg; inf where
        the object is faster than any inertia makes it); nan where a joint does not hit.

    Raises:
        InputError: an argument cannot be used.
        ModelError: the rotor inertia is not known.
    """
    import xarray as xr

    h, mass = unit(direction), positive_mass(mass)
    xs, ys = np.atleast_1d(np.asarray(x, dtype=float)), np.atleast_1d(np.asarray(y, dtype=float))
    places = np.array([(a, b, z) for a in xs for b in ys])
    chosen = robot.contacts(joints)
    shape = (len(chosen), len(times), len(places))
    thrown, equivalent = np.full(shape, np.nan), np.full(shape, np.nan)
    for k, contact in enumerate(chosen):
        best, speed = _best(robot, contact, places, h, mass, samples, seed)
        for cell in counted(np.flatnonzero(speed > 0), f"places of joint {contact.joint}"):
            for i, time in enumerate(times):
                hit = elastic_impact(
                    robot, best[cell], contact, h, mass, float(speed[cell]), restitution, time,
                    stiffness, rotor_inertia=rotor_inertia,
                )  # fmt: skip
                thrown[k, i, cell] = hit.object_speed
                equivalent[k, i, cell] = np.inf if hit.equivalent is None else hit.equivalent
    grid = (len(chosen), len(times), len(xs), len(ys))
    over = ("joint", "time", "x", "y")
    columns = {"object_speed": thrown, "equivalent": equivalent}
    made = xr.Dataset(
        {name: (over, values.reshape(grid)) for name, values in columns.items()},
        coords={"joint": [c.joint for c in chosen], "time": list(times), "x": xs, "y": ys},
    )
    told = {"z": z, "direction": h.tolist(), "mass": mass, "restitution": restitution}
    return described(made, robot, samples=samples, **told)


def _best(
    robot: Robot, contact: Contact, places: Array, h: Array, mass: float, samples: int, seed: int
) -> tuple[Array, Array]:
    """Return each place's configuration of the greatest straight flux (P, n), and its speed (P,).

    The speed is 0 where the joint does not reach, or cannot move along the direction.
    """
    placed = place_joint(robot, contact, np.repeat(places, samples, axis=0), seed)
    told = kernel_for(robot, (contact,), ("straight_speed", "straight_flux"))(placed.q, h, mass)
    flux = np.where(placed.solved, told["straight_flux"][0], 0.0).reshape(-1, samples)
    best = np.argmax(flux, axis=1) + samples * np.arange(len(places))
    speed = np.where(placed.solved, told["straight_speed"][0], 0.0)[best]
    return placed.q[best], np.where(flux.max(axis=1) > 1e-3, speed, 0.0)
