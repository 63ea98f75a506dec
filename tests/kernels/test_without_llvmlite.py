"""Everything works, slowly, where llvmlite is not installed."""

import subprocess
import sys

SCRIPT = """
import sys
sys.modules["llvmlite"] = sys.modules["llvmlite.binding"] = None
import numpy as np
import hitjoints as hj
from hitjoints.kernels.tape.backends import choose

assert choose() == "numpy"
robot, h = hj.load_robot("iiwa14"), np.array([0.0, 1.0, 0.0])
q = robot.home
one = hj.directional_inertia(robot, q, 6, h)
assert abs(hj.directional_inertia(robot, [q], 6, h)[0] - one) < 1e-9
assert abs(hj.Evaluator(robot, 6)(q, h).inertia - one) < 1e-9
at = hj.position(robot, q, 6)
assert hj.place_joint(robot, 6, at).solved[0]
control = hj.Controller(robot, hj.Hit(6, at + 0.1 * h, h, 2.0, 0.1), q, posture=q)
assert control.step(q) @ (h @ hj.jacobian(robot, q, 6)) > 0
found = hj.rollouts(robot, hj.Hit(6, at + 0.1 * h, h, 2.0, 0.1), q, q_hit=None)
assert found.steps[0] > 0 and found.within_limits[0]
assert "llvmlite.binding" not in [name for name, module in sys.modules.items() if module]
print("fine")
"""


def test_without_llvmlite():
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == "fine"
