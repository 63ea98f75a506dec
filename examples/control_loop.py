"""The controller in a loop of your own at 1 kHz, here with an arm in MuJoCo: extra `sim`.

Replace `Arm` by what talks to your robot: it reports joint positions and takes velocities.
"""

from time import perf_counter

import mujoco
import numpy as np

import hitjoints as hj

PERIOD = 0.001  # s, 1 kHz
GAIN = 200.0  # N m s/rad, of the servos


class Arm:
    """A simulated arm: a velocity servo at every joint, within its torque; gravity compensated."""

    def __init__(self, robot: hj.Robot, q: np.ndarray) -> None:
        spec = mujoco.MjSpec.from_string(robot.xml)
        for body in spec.bodies[1:]:
            body.gravcomp = 1
        for geom in spec.geoms:
            geom.contype = geom.conaffinity = 0  # nothing to touch here
        for name, torque in zip(robot.joint_names, robot.effort, strict=True):
            servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
            servo.set_to_velocity(kv=GAIN)
            servo.forcerange, servo.forcelimited = (-torque, torque), True
        spec.option.timestep = PERIOD / 4
        spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)
        self.data.qpos[:] = q

    def read(self) -> np.ndarray:
        """Return the measured joint positions, rad."""
        return self.data.qpos.copy()

    def command(self, qd: np.ndarray) -> None:
        """Have the servos follow the velocity (rad/s) for one period."""
        self.data.ctrl[:] = qd
        mujoco.mj_step(self.model, self.data, nstep=4)


robot = hj.load_robot("iiwa14")
hit = hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], mass=2.0, flux=0.3)
found = hj.plan(
    robot, hit.position, hit.direction, joints=[6], mass=hit.mass,
    objective="straight-flux", flux=hit.flux, start=True,
)  # fmt: skip
controller = hj.Controller(robot, hit, found.best.q, dt=PERIOD)
arm = Arm(robot, found.start.q)

taken = []  # s, by each step
while len(taken) < 3000:  # a loop on a robot is bounded, too
    began = perf_counter()
    qd = controller.step(arm.read())
    taken.append(perf_counter() - began)
    if controller.arrived:
        break
    arm.command(qd)
assert controller.arrived, "the arm did not come to the object"
last = controller.last

velocity = hj.jacobian(robot, arm.data.qpos, 6) @ arm.data.qvel
speed = velocity @ hit.direction
miss = 1e3 * np.linalg.norm(last.position - hit.position)
print(f"{miss:.2f} mm off after {len(taken)} steps of {1e3 * PERIOD:g} ms")
print(f"a step takes {1e6 * np.median(taken):.0f} us (median)")
print(f"inertia {last.inertia:.2f} kg, aimed for {last.desired_inertia:.2f} kg")
print(f"flux {hj.hitting_flux(last.inertia, hit.mass, speed):.3f} m/s, {hit.flux:g} m/s wanted")
