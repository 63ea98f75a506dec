"""Turn the hitting joint and watch inertia, speed and flux: the paper's Fig. 2."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of, kernel_for
from hitjoints.datasets.describe import described
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError
from hitjoints.hit import Hit
from hitjoints.hit_setting import setting_of
from hitjoints.impact.collision import hitting_flux
from hitjoints.impact.inertia_models import InertiaModel, impact_inertia
from hitjoints.model.robot import Contact
from hitjoints.quantities import place_joint
from hitjoints.vectors import LARGEST_SEED, points, positive_mass, unit, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.model.robot import Robot

MOST_ANGLES = 1_000_000
"""Per joint."""
OUTPUTS = ("inertia", "speed", "straight_speed")


def sweep_joint(  # noqa: PLR0913
    robot: Robot,
    position: ArrayLike,
    direction: ArrayLike,
    mass: float,
    *,
    joints: Sequence[Contact | int] | None = None,
    count: int = 181,
    start: ArrayLike | None = None,
    impact: InertiaModel = "rigid",
    rotor_inertia: ArrayLike | None = None,
    seed: int = 0,
) -> Dataset:
    """Place each joint at a point, then turn that joint over its range (Section III-A, Fig. 2).

    A contact with an offset is placed at the point and leaves it as the joint turns.
    Every joint is placed by inverse kinematics from one common configuration, so the arms stay
    close to each other in joint space. Turning joint k changes neither its position nor its
    speed, but the inertia and with it the flux.

    Args:
        robot: the arm.
        position: (3,) m, where the object is.
        direction: (3,), the hitting direction.
        mass: of the object, kg.
        joints: hitting joints or contacts; the robot's own when not given.
        count: angles per joint.
        start: (n,) rad, the common configuration; the robot's home when not given.
        impact: model of the inertia, see `impact_inertia`.
        rotor_inertia: for it, kg m^2; the robot's when not given.
        seed: of the inverse kinematics' random restarts, needed when `start` leads nowhere.

    Returns:
        A data set over (joint, sample): angle, inertia, speed, straight_speed, flux,
        straight_flux; over joint: reachable, position_error, q. An unreachable joint holds nan.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: no joint reaches the position.
    """
    chosen = robot.contacts(joints)
    count = whole(count, "count", 2, MOST_ANGLES)
    seed = whole(seed, "seed", 0, LARGEST_SEED)
    target = points(position, "position").reshape(3)
    h = unit(direction)
    common = robot.within_limits(robot.home if start is None else start, "start")
    rows = [_turn(robot, k, target, h, common, count, seed) for k in chosen]
    if impact != "rigid":
        for row, contact in zip(rows, chosen, strict=True):
            turned = _turned(row["q"], contact.joint, row["angle"])
            shown = impact_inertia(robot, turned, contact, h, impact, rotor_inertia=rotor_inertia)
            row["inertia"] = np.where(row["reachable"], shown, np.nan)
    if not any(row["reachable"] for row in rows):
        raise InfeasibleError(
            f"unreachable: no joint of {[contact.joint for contact in chosen]} can be placed at "
            f"({', '.join(f'{v:g}' for v in target)}); the closest, joint "
            f"{min(rows, key=lambda r: r['position_error'])['joint']}, stays "
            f"{min(r['position_error'] for r in rows):.3g} m away",
            {"position_error": {r["joint"]: r["position_error"] for r in rows}},
        )
    swept = _assemble(robot, rows, target, h, positive_mass(mass))
    setting = replace(setting_of(robot, chosen), q0=tuple(common.tolist()), seed=seed)
    return swept.assign_attrs(
        impact=impact,
        offsets=[list(contact.offset) for contact in chosen],
        hit=Hit(None, target, h, float(mass), setting=setting).text,
    )


def _turn(
    robot: Robot, contact: Contact, target: Any, h: Any, common: Any, count: int, seed: int
) -> dict[str, Any]:
    joint = contact.joint
    row: dict[str, Any] = {"joint": joint}
    if chain_of(robot).attach(contact.joint, contact.offset)[0]:
        placed = place_joint(robot, contact, target, seed, start=common)
        q, reachable = placed.q[0], bool(placed.solved[0])
        row["position_error"] = float(placed.error[0])
    else:
        # A point on the first joint's axis stays where it is, and hits nothing there.
        q, reachable = common, False
        row["position_error"] = float(np.linalg.norm(position(robot, q, contact) - target))
    row |= {"q": q, "reachable": reachable}
    low, high = (ends[joint - 1] for ends in robot.finite_limits)
    row["angle"] = np.linspace(low, high, count)
    if not reachable:
        return row | {name: np.full(count, np.nan) for name in OUTPUTS}
    values = kernel_for(robot, (contact,), OUTPUTS)(_turned(q, joint, row["angle"]), h)
    return row | {name: values[name][0] for name in OUTPUTS}


def _turned(q: Any, joint: int, angle: Any) -> Any:
    rows = np.tile(q, (len(angle), 1))
    rows[:, joint - 1] = angle
    return rows


def _assemble(
    robot: Robot, rows: list[dict[str, Any]], target: Any, h: Any, mass: float
) -> Dataset:
    import xarray as xr

    over_angle, per_joint = ("joint", "sample"), ("joint",)
    columns = {name: np.stack([row[name] for row in rows]) for name in ("angle", *OUTPUTS)}
    reached = np.array([row["reachable"] for row in rows])
    for speed, flux in (("speed", "flux"), ("straight_speed", "straight_flux")):
        columns[flux] = np.full_like(columns[speed], np.nan)
        columns[flux][reached] = hitting_flux(
            columns["inertia"][reached], mass, columns[speed][reached]
        )
    dataset = xr.Dataset(
        {name: (over_angle, values) for name, values in columns.items()}
        | {
            "reachable": (per_joint, reached),
            "position_error": (per_joint, np.array([row["position_error"] for row in rows])),
            "q": (("joint", "axis"), np.stack([row["q"] for row in rows])),
        },
        coords={
            "joint": [row["joint"] for row in rows],
            "axis": np.arange(1, robot.n + 1),
        },
    )
    return described(dataset, robot, position=target.tolist(), direction=h.tolist(), mass=mass)
