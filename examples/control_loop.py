"""The controller inside a control loop of your own, here against a simulated joint interface.

Replace `Joints` by what talks to your robot: it reports joint positions and takes velocities.
"""

import numpy as np

import hitjoints as hj
from hitjoints.hit import Hit
from hitjoints.hitting.controller import Controller
from hitjoints.rollouts.prepare import prepare

PERIOD = 0.002  # s, 500 Hz


class Joints:
    """Joints that follow a commanded velocity with a delay of one time constant."""

    def __init__(self, q: np.ndarray, lag: float = 0.004) -> None:
        self.q, self.qd, self.lag = np.array(q), np.zeros(len(q)), lag

    def read(self) -> np.ndarray:
        """Return the measured joint positions, rad."""
        return self.q.copy()

    def command(self, qd: np.ndarray) -> None:
        """Follow the velocity (rad/s) for one period."""
        self.qd += (qd - self.qd) * (1 - np.exp(-PERIOD / self.lag))
        self.q += PERIOD * self.qd


robot = hj.load_robot("iiwa14")
hit = Hit(6, np.array([0.5, 0.3, 0.5]), np.array([0.0, 1.0, 0.0]), mass=2.0, flux=0.3)
ready = prepare(robot, hit)  # plans the hitting configuration and the start behind it
controller = Controller(robot, hit, ready.q_hit, dt=PERIOD)
joints = Joints(ready.q0)

for _ in range(2000):  # a loop on a robot is bounded, too
    qd = controller.step(joints.read())
    if controller.arrived:
        break
    joints.command(qd)
assert controller.arrived
last = controller.last
assert last is not None

velocity = hj.jacobian(robot, joints.q, 6) @ joints.qd
print(f"{1e3 * np.linalg.norm(last.position - hit.position):.2f} mm from the object")
print(f"inertia {last.inertia:.2f} kg, aimed for {last.desired_inertia:.2f} kg")
print(f"flux {hj.hitting_flux(last.inertia, hit.mass, velocity @ hit.direction):.3f} m/s")
