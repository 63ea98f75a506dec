"""`sweep workspace`, the whole command, against the same work by a Pinocchio loop."""

from __future__ import annotations

import subprocess
import sys
import tempfile

import numpy as np

import hitjoints as hj
from benchmarks import pinocchio_loop
from benchmarks.harness import Row, compare

AXIS, SAMPLES, JOINTS = 20, 100, (5, 6, 7)
PEER_SAMPLES = 300  # of the 2.4 million: the loop's time is proportional
ARGUMENTS = (
    "--x=0.2:0.6:20", "--y=-0.3:0.3:20", "--z=0.3:0.7:20", "--samples", str(SAMPLES), "--json"
)  # fmt: skip


def measure() -> list[Row]:
    """Return how much faster a map of 20 x 20 x 20 positions is, imports and disk included."""
    robot = hj.load_robot("iiwa14")
    model, data, rng = robot.model, robot.model.createData(), np.random.default_rng(0)
    limits, h = robot.velocity_upper, np.array([0.0, 1.0, 0.0])
    targets = rng.uniform([0.2, -0.3, 0.3], [0.5, 0.3, 0.6], (PEER_SAMPLES, 3))

    def command() -> None:
        with tempfile.TemporaryDirectory() as folder:
            words = [sys.executable, "-m", "hitjoints.cli", "sweep", "workspace", *ARGUMENTS]
            done = subprocess.run(
                [*words, "--out", "map.zarr"], cwd=folder, check=False, capture_output=True
            )
            assert done.returncode == 0, done.stderr

    def loop() -> None:
        for i, target in enumerate(targets):
            joint = JOINTS[i % 3]
            q = pinocchio_loop.place(model, data, joint, target, rng)
            if q is not None:
                value, g, _ = pinocchio_loop.inertia(model, data, q, joint, h)
                _ = value / (value + 2.0) * (np.abs(g) @ limits)

    evaluations = AXIS**3 * len(JOINTS) * SAMPLES
    row = compare(
        f"map of {AXIS}^3 positions, 3 joints, {SAMPLES} samples (per sample)",
        ("hitjoints sweep workspace, whole command", command, evaluations),
        ("Pinocchio loop", loop, PEER_SAMPLES),
        repeats=3,
    )
    print(f"whole command: {row.ours_time * evaluations:.2f} s", file=sys.stderr)
    return [row]
