"""The box on the table, from the parting until it rests, in the physics engine."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import SolverError
from hitjoints.evidence.physics.engine_box import add_box, add_table, set_options
from hitjoints.model.engine import compiled, engine

if TYPE_CHECKING:
    from hitjoints.evidence.physics.first_touch import ImpactState
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.types import Array

STEP = 5e-5
"""s."""
SETTLING = 5e-4
"""s, in which the table takes the weight: shorter than a box takes to come down on it."""
AT_REST = 1e-3
"""m/s and rad/s: slower than this the box rests."""
LONGEST = 60.0
"""s, of sliding that is followed."""
ROWS = 400
"""Of the data set, at most."""


@dataclass(frozen=True, eq=False)
class Slide:
    """How the box came to rest.

    Attributes:
        turned: rad, about the vertical.
        tipped: it fell over, and was not followed any further.
        rows: `slide_time` (s, since the parting), `slide_position` (T, 3) m, `slide_quaternion`
            (T, 4), and `slide_speed` (m/s), along the direction.
    """

    turned: float
    tipped: bool
    rows: dict[str, Array] = field(repr=False)


def slide(impact: ImpactState, setting: EngineSetting, qpos: Array, qvel: Array) -> Slide:
    """Let the box slide until it rests. The arm is not there any more.

    Args:
        impact: of the hit; the direction is level and the table has friction.
        setting: of the hit; the direction is level and the table has friction.
        qpos: (7,) position and quaternion, and (6,) velocity of the box at the parting.
        qvel: (7,) position and quaternion, and (6,) velocity of the box at the parting.

    Raises:
        SolverError: it does not come to rest.
    """
    mujoco = engine()
    h = impact.direction
    spec = mujoco.MjSpec()
    set_options(spec, STEP)
    centre = impact.box_centre(setting)
    add_box(spec, centre, impact.box_axes(setting), impact.mass, setting.size)
    add_table(spec, centre, setting.size, setting.friction, setting.support, SETTLING)
    model = compiled(spec, "box")
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    data.qpos[2] -= GRAVITY * SETTLING**2  # the springs bear the weight at once
    times, poses, speeds, tipped = [0.0], [data.qpos.copy()], [float(h @ data.qvel[:3])], False
    while np.abs(data.qvel).max() > AT_REST and not tipped:
        if len(times) * STEP > LONGEST:
            raise SolverError(f"the box does not come to rest within {LONGEST:g} s")
        mujoco.mj_step(model, data)
        if not np.isfinite(data.qvel).all():
            raise SolverError("the engine loses the box while it slides")
        tipped = is_tipped(data.body("box").xmat, setting.size)
        times.append(data.time)
        poses.append(data.qpos.copy())
        speeds.append(float(h @ data.qvel[:3]))
    kept = np.unique(np.linspace(0, len(times) - 1, min(ROWS, len(times))).astype(int))
    pose = np.array(poses)
    rows = {
        "slide_time": np.array(times)[kept],
        "slide_position": pose[kept, :3],
        "slide_quaternion": pose[kept, 3:],
        "slide_speed": np.array(speeds)[kept],
    }
    return Slide(turned(pose[:, 3:]), tipped, rows)


def turned(quaternions: Array) -> float:
    """Return by how much a box turned about the vertical, rad, from (T, 4) rows close in time."""
    w, x, y, z = quaternions.T
    heading = np.unwrap(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
    return float(heading[-1] - heading[0])


def is_tipped(rotation: Any, size: tuple[float, float, float]) -> bool:
    """Tell whether a box on its edge has its centre beyond it.

    Args:
        rotation: (9,) of the box, row by row.
        size: (3,) m, of the box.
    """
    up = np.abs(rotation[6:8])
    return bool((up * size[2] > rotation[8] * np.array(size[:2])).any())
