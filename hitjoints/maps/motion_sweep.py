"""Maps of the flux that motions really deliver, over object positions: `sweep_motion`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import InputError
from hitjoints.hitting.controller import SHORTEST
from hitjoints.hitting.field import RATE
from hitjoints.maps.cells import MOST_SAMPLES
from hitjoints.maps.grid import make_grid
from hitjoints.maps.motion_cells import MotionQuestion
from hitjoints.maps.run_sweep import Progress, Work, run_sweep
from hitjoints.vectors import LARGEST_SEED, positive_mass, unit, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.model.robot import Contact, Robot

POSITIONS_AT_ONCE = 64
"""In a block: what a kill can cost."""
MOST_TRIES = 1000


def sweep_motion(  # noqa: PLR0913
    robot: Robot,
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    directions: ArrayLike,
    mass: float,
    *,
    joints: Iterable[Contact | int] | None = None,
    samples: int = 100,
    tries: int = 8,
    dt: float = 0.004,
    seed: int = 0,
    out: str | Path | None = None,
    scheduler: str | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    command: str = "",
) -> Dataset:
    """Map the flux that hitting motions deliver, by rolling them out.

    At every position each joint is placed by `samples` random inverse-kinematics solutions, as for
    `sweep_workspace`. The `tries` of them with the greatest straight flux are moved back along the
    direction by the run-up that the field needs, and from there the controller hits, asked for that
    flux. The map holds the motion that arrives with the most: on the object to 20 mm, along the
    direction to 5 degrees, within all position and velocity limits.

    Args:
        robot: see `sweep_workspace`.
        x: see `sweep_workspace`.
        y: see `sweep_workspace`.
        z: see `sweep_workspace`.
        directions: see `sweep_workspace`.
        mass: see `sweep_workspace`.
        joints: see `sweep_workspace`.
        samples: see `sweep_workspace`.
        tries: motions per position, joint and direction.
        dt: s, of the control steps.
        seed: see `sweep_workspace`.
        out: see `sweep_workspace`.
        scheduler: see `sweep_workspace`.
        threads: see `sweep_workspace`.
        progress: see `sweep_workspace`.
        command: see `sweep_workspace`.

    Returns:
        A data set over (joint, direction, x, y, z), of the motion that delivers the greatest flux:
        `flux`, `inertia`, `speed`, `miss`, `direction_error`, `time` and `q` at the impact, `q0` at
        its start, `q_hit`, the configuration it was made for, and the `straight_flux` of that,
        which was asked for; `acceleration_ratio` and `torque_ratio`, the greatest in units of the
        limits; `hits`, the share of the motions that arrive so; `reachable` (joint, x, y, z), the
        share of the samples that reach the position. nan where none arrives, or a limit is not
        known.

    Raises:
        InputError: an argument cannot be used, or `out` holds another map.
    """
    if not SHORTEST <= dt <= 1.0 / RATE:
        raise InputError("dt", dt, f"a step of {SHORTEST:g} s to {1 / RATE:g} s")
    question = MotionQuestion(
        robot,
        contacts=robot.contacts(joints),
        directions=np.atleast_2d(unit(directions)),
        mass=positive_mass(mass),
        samples=whole(samples, "samples", 1, MOST_SAMPLES),
        seed=whole(seed, "seed", 0, LARGEST_SEED),
        tries=whole(tries, "tries", 1, MOST_TRIES),
        dt=float(dt),
    )
    grid = make_grid(x, y, z, POSITIONS_AT_ONCE)
    return run_sweep(question, grid, out, Work(scheduler, threads, progress, command))
