"""A box let go on a table in MuJoCo, standing on its four corners, until it rests."""

from __future__ import annotations

from typing import Any

import numpy as np

STIFF = 4e-3  # s, time constant of the table's springs and dampers
DT = 1e-4
AT_REST = 2e-4  # m/s

SCENE = """
<mujoco>
  <option timestep="{dt}" cone="elliptic" integrator="implicitfast" gravity="0 0 -9.81"/>
  <worldbody>
    <geom name="table" type="plane" size="10 10 1" contype="0" conaffinity="0"/>
    <body name="box" pos="0 0 {up}">
      <freejoint/>
      <geom type="box" size="{a} {b} {up}" mass="1" contype="0" conaffinity="0"/>
      {feet}
    </body>
  </worldbody>
  <contact>{pairs}</contact>
</mujoco>
"""


def let_go(
    size: Any, velocity: Any, spin: float, friction: float
) -> tuple[np.ndarray[Any, Any], float]:
    """Return displacement (2,) m and yaw (rad) of a box (3,) m until it rests."""
    import mujoco

    a, b, up = (edge / 2 for edge in size)
    radius, feet, pairs = 1e-3, "", ""
    for i, (x, y) in enumerate((x, y) for x in (-a, a) for y in (-b, b)):
        feet += (
            f'<geom name="f{i}" type="sphere" size="{radius}" pos="{x} {y} {-up + radius}" '
            'mass="0" contype="0" conaffinity="0"/>'
        )
        pairs += (
            f'<pair geom1="table" geom2="f{i}" condim="3" friction="{friction} {friction} 0 0 0" '
            f'solref="-{1 / STIFF**2} -{2 / STIFF}" solimp="0.15 0.15 1 0.5 1"/>'
        )
    model = mujoco.MjModel.from_xml_string(
        SCENE.format(dt=DT, up=up, a=a, b=b, feet=feet, pairs=pairs)
    )
    data = mujoco.MjData(model)
    for _ in range(int(0.05 / DT)):  # the springs take the weight first
        mujoco.mj_step(model, data)
    begin = data.qpos[:2].copy()
    data.qvel[:2], data.qvel[5] = velocity, spin
    turned, before = 0.0, _heading(data)
    while np.hypot(*data.qvel[:2]) + a * abs(data.qvel[5]) > AT_REST and data.time < 10:
        mujoco.mj_step(model, data)
        now = _heading(data)
        turned += (now - before + np.pi) % (2 * np.pi) - np.pi
        before = now
    return data.qpos[:2] - begin, turned


def _heading(data: Any) -> float:
    w, x, y, z = data.qpos[3:7]
    return float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
