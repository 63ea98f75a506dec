"""The box on the table, from the parting until it rests, in the physics engine."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import SolverError
from hitjoints.evidence.physics.engine_scene import add_box, add_table, set_options
from hitjoints.model.engine import compiled, engine

if TYPE_CHECKING:
    from hitjoints.evidence.physics.engine_scene import ImpactState
    from hitjoints.evidence.physics.setting import EngineSetting
    from hitjoints.types import Array

STEP = 2e-4
"""s."""
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
        rows: `slide_time` (s, since the parting), `slide_position` (T, 3) m, `slide_quaternion`
            (T, 4), and `slide_speed` (m/s), along the direction.
    """

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
    add_box(spec, centre, impact.axes, impact.mass, setting.size)
    add_table(spec, centre, setting.size, setting.friction)
    model = compiled(spec, "box")
    data = mujoco.MjData(model)
    data.qpos[:], data.qvel[:] = qpos, qvel
    times, poses, speeds = [0.0], [data.qpos.copy()], [float(h @ data.qvel[:3])]
    while np.abs(data.qvel).max() > AT_REST:
        if len(times) * STEP > LONGEST:
            raise SolverError(f"the box does not come to rest within {LONGEST:g} s")
        mujoco.mj_step(model, data)
        if not np.isfinite(data.qvel).all():
            raise SolverError("the engine loses the box while it slides")
        times.append(data.time)
        poses.append(data.qpos.copy())
        speeds.append(float(h @ data.qvel[:3]))
    kept = np.unique(np.linspace(0, len(times) - 1, min(ROWS, len(times))).astype(int))
    pose = np.array(poses)[kept]
    rows = {
        "slide_time": np.array(times)[kept],
        "slide_position": pose[:, :3],
        "slide_quaternion": pose[:, 3:],
        "slide_speed": np.array(speeds)[kept],
    }
    return Slide(rows)
