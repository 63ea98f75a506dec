"""Maps of inertia, speed and flux over object positions: `sweep_workspace`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.maps.cells import MOST_SAMPLES, Question
from hitjoints.maps.grid import make_grid
from hitjoints.maps.run_sweep import Progress, Work, run_sweep
from hitjoints.vectors import LARGEST_SEED, positive_mass, unit, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import DataArray, Dataset

    from hitjoints.model.robot import Contact, Robot

POSITIONS_PER_BLOCK = 2000  # what a kill can cost, and the finest grain of a cluster's work


def sweep_workspace(  # noqa: PLR0913
    robot: Robot,
    x: ArrayLike,
    y: ArrayLike,
    z: ArrayLike,
    directions: ArrayLike,
    mass: float,
    *,
    joints: Iterable[Contact | int] | None = None,
    samples: int = 100,
    seed: int = 0,
    out: str | Path | None = None,
    scheduler: str | None = None,
    threads: int | None = None,
    progress: Progress | None = None,
    command: str = "",
) -> Dataset:
    """Map a grid of object positions by sampling each hitting joint's self-motion there.

    At every position each joint is placed by `samples` random inverse-kinematics solutions (Eq. 8;
    the joints beyond the hitting joint are drawn within their limits), and inertia, speed (Eq. 9)
    and flux (Eq. 10) are evaluated at each.

    Args:
        robot: the arm.
        x: coordinates of the grid, ascending, m.
        y: coordinates of the grid, ascending, m.
        z: coordinates of the grid, ascending, m.
        directions: (3,) or (D, 3) hitting directions.
        mass: of the object, kg.
        joints: hitting joints or contacts; the robot's own when not given.
        samples: configurations per position and joint.
        seed: of the configurations. The map depends on nothing else: not on threads, on the
            scheduler, or on interruptions.
        out: path of the Zarr store; a run that was killed goes on where it stopped. A temporary
            one, held in memory afterwards, when not given.
        scheduler: address of a Dask scheduler (extra `dask`).
        threads: threads of this process; all available processors when not given.
        progress: called with (positions done, positions in all) after every block.
        command: what to write into the store as its origin.

    Returns:
        A data set over (joint, direction, x, y, z). `flux`, `inertia`, `speed`, `straight_speed`,
        `straight_flux` and `q` belong to the sample of the greatest flux; `inertia_min`,
        `inertia_median`, `inertia_max`, `speed_max`, `flux_median` to all; `away` tells whether a
        sample points its distal links away from the object (Eq. 14), `away_flux` the greatest flux
        among those; `reachable` (joint, x, y, z) is the share of samples that reach the position.
        nan where none does.

    Raises:
        InputError: an argument cannot be used, or `out` holds another map.
    """
    question = Question(
        robot,
        contacts=robot.contacts(joints),
        directions=np.atleast_2d(unit(directions)),
        mass=positive_mass(mass),
        samples=whole(samples, "samples", 1, MOST_SAMPLES),
        seed=whole(seed, "seed", 0, LARGEST_SEED),
    )
    grid = make_grid(x, y, z, POSITIONS_PER_BLOCK)
    work = Work(scheduler, threads, progress, command)
    return run_sweep(question, grid, out, work)


def best_joint(dataset: Dataset, quantity: str = "flux") -> DataArray:
    """Return the joint of the greatest `quantity` at each position and direction, nan for none."""
    values = dataset[quantity]
    best = values.fillna(-np.inf).argmax("joint")
    joints = dataset.joint.values[best.values].astype(float)
    return best.copy(data=joints).where(values.notnull().any("joint"))
