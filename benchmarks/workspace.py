"""`sweep workspace`, the whole command, against the same work by a Pinocchio loop."""

from __future__ import annotations

import subprocess
import sys
import tempfile

import numpy as np

import hitjoints as hj
from benchmarks.harness import Figure, Row, compare
from benchmarks.peers import pinocchio

AXIS, SAMPLES, JOINTS = 20, 100, (5, 6, 7)
PEER_SAMPLES = 300  # of the 2.4 million: the loop's time is proportional
ARGUMENTS = (
    "--x=0.2:0.6:20", "--y=-0.3:0.3:20", "--z=0.3:0.7:20", "--samples", str(SAMPLES), "--json"
)  # fmt: skip


def measure() -> list[Row | Figure]:
    """Return how much faster a map of 20 x 20 x 20 positions is, imports and disk included."""
    robot = hj.load_robot("iiwa14")
    model, data, rng = robot.model, robot.model.createData(), np.random.default_rng(0)
    limits, h = robot.velocity_upper, np.array([0.0, 1.0, 0.0])
    somewhere = rng.uniform([0.2, -0.3, 0.3], [0.6, 0.3, 0.7], (10 * PEER_SAMPLES, 3))
    # The loop is spared what is out of reach, where it would spend all its restarts.
    reached = [somewhere[hj.place_joint(robot, k, somewhere).solved] for k in JOINTS]

    def command() -> None:
        with tempfile.TemporaryDirectory() as folder:
            words = [sys.executable, "-m", "hitjoints.cli", "sweep", "workspace", *ARGUMENTS]
            done = subprocess.run(
                [*words, "--out", "map.zarr"], cwd=folder, check=False, capture_output=True
            )
            assert done.returncode == 0, done.stderr

    def loop() -> None:
        for joint, targets in zip(JOINTS, reached, strict=True):
            for target in targets[: PEER_SAMPLES // 3]:
                q = pinocchio.place(model, data, joint, target, rng)
                value, g, _ = pinocchio.inertia(model, data, q, joint, h)
                _ = value / (value + 2.0) * (np.abs(g) @ limits)

    evaluations = AXIS**3 * len(JOINTS) * SAMPLES
    row = compare(
        f"map of {AXIS}^3 positions, 3 joints, {SAMPLES} samples (per sample)",
        ("hitjoints sweep workspace, whole command", command, evaluations),
        ("Pinocchio loop", loop, PEER_SAMPLES),
        repeats=3,
    )
    whole = row.ours_time * evaluations
    return [row, Figure("the same map, whole command written to disk", whole, "s", "<= 6")]
