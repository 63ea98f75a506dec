"""Hit with an arm of your own: any serial arm in a URDF will do, this one moves in a plane."""

import tempfile
from pathlib import Path

import numpy as np

import hitjoints as hj

LINK = """
  <link name="link_{i}"><inertial><origin xyz="0.15 0 0"/><mass value="{mass}"/>
    <inertia ixx="0.002" iyy="0.012" izz="0.012" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="joint_{i}" type="revolute"><parent link="{parent}"/><child link="link_{i}"/>
    <origin xyz="0.3 0 0"/><axis xyz="0 0 1"/>
    <limit lower="-2.5" upper="2.5" velocity="2" effort="30"/></joint>"""


def urdf(joints: int) -> str:
    """Return an arm of equal links, 0.3 m long, that turn about z."""
    parents = ["base", *(f"link_{i}" for i in range(1, joints))]
    links = "".join(
        LINK.format(i=i, parent=p, mass=2 - 0.2 * i) for i, p in enumerate(parents, start=1)
    )
    return f'<robot name="planar"><link name="base"/>{links}</robot>'


with tempfile.TemporaryDirectory() as folder:
    file = Path(folder) / "planar.urdf"
    file.write_text(urdf(joints=4))
    robot = hj.load_robot(file)

start = np.array([0.3, 0.8, -0.5, 0.2])
contact = hj.Contact(4, offset=(0.1, 0.05, 0.0))  # the surface of the last link
away = np.array([-1.0, 0.3, 0.0])
target = hj.position(robot, start, contact) + 0.15 * away
result = hj.rollout(robot, hj.Hit(contact, target, away, mass=0.5, flux=0.1), q0=start)
assert result.impact is not None, result.reason
print(f"{robot.name}: {robot.n} joints, hit with {contact}")
print(f"inertia {result.impact.inertia:.3f} kg, flux {result.impact.flux:.4f} m/s")
print(f"{1e3 * result.impact.miss:.2f} mm off after {result.steps} steps")
