"""`sweep workspace`, the whole command, against the same work by loops in Pinocchio and MuJoCo."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from functools import partial
from typing import Any

import numpy as np

import hitjoints as hj
from benchmarks.contest import Peer, contest, near
from benchmarks.harness import Figure, Remark, Row, Work
from benchmarks.peers.mujoco import MuJoCoArm
from benchmarks.peers.pinocchio import PinocchioArm
from benchmarks.single_call import EXACT, placed

Sample = tuple[Any, float, float]  # q (n,) rad, inertia in kg, flux in m/s

H, MASS = np.array([0.0, 1.0, 0.0]), 2.0  # kg
AXIS, SAMPLES, JOINTS = 20, 100, (5, 6, 7)
PEER_SAMPLES = 300  # of the 2.4 million: the loop's time is proportional
ARGUMENTS = (
    "--x=0.2:0.6:20", "--y=-0.3:0.3:20", "--z=0.3:0.7:20", "--samples", str(SAMPLES), "--json"
)  # fmt: skip


def measure() -> list[Row | Figure | Remark]:
    """Return how much faster a map of 20 x 20 x 20 positions is, imports and disk included."""
    robot, rng = hj.load_robot("iiwa14"), np.random.default_rng(0)
    somewhere = rng.uniform([0.2, -0.3, 0.3], [0.6, 0.3, 0.7], (10 * PEER_SAMPLES, 3))
    # The loops are spared what is out of reach, where they would spend all their restarts.
    reached = [somewhere[hj.place_joint(robot, k, somewhere).solved] for k in JOINTS]
    targets = [points[: PEER_SAMPLES // len(JOINTS)] for points in reached]
    evaluations = AXIS**3 * len(JOINTS) * SAMPLES
    rows = contest(
        "a sample of a map",
        (f"hitjoints sweep workspace, {AXIS}^3 x 3 x {SAMPLES} samples", command, evaluations),
        [
            Peer(f"{name} loop", partial(loop, arm, robot, targets), PEER_SAMPLES)
            for name, arm in (("Pinocchio", PinocchioArm), ("MuJoCo", MuJoCoArm))
        ],
        partial(_agrees, robot, targets),
        repeats=3,
    )
    whole = evaluations * min(row.ours_time for row in rows if isinstance(row, Row))
    return [*rows, Figure("the whole map, written to disk", whole, "s", "<= 6")]


def command() -> None:
    """Run the command in a folder of its own."""
    with tempfile.TemporaryDirectory() as folder:
        words = [sys.executable, "-m", "hitjoints.cli", "sweep", "workspace", *ARGUMENTS]
        done = subprocess.run(
            [*words, "--out", "map.zarr"], cwd=folder, check=False, capture_output=True
        )
        assert done.returncode == 0, done.stderr


def loop(arm: type[Any], robot: hj.Robot, targets: list[Any]) -> Work:
    """Return the work of one sample per target: a configuration and what is felt and hit there."""
    peers = [arm(robot, joint) for joint in JOINTS]

    def work() -> list[list[Sample]]:
        rng = np.random.default_rng(0)
        return [
            [_sample(peer, robot, target, rng) for target in points]
            for peer, points in zip(peers, targets, strict=True)
        ]

    return work


def _sample(peer: Any, robot: hj.Robot, target: Any, rng: np.random.Generator) -> Sample:
    q = peer.place(target, rng)
    inertia, pull = peer.inertia_and_pull(q, H)
    return q, inertia, inertia / (inertia + MASS) * (np.abs(pull) @ robot.velocity_upper)


def _agrees(robot: hj.Robot, targets: list[Any], answer: list[list[Sample]] | None) -> str:
    """Return what is wrong with a loop's samples; the command has been checked already."""
    for joint, points, samples in zip(JOINTS, targets, answer or [], strict=answer is not None):
        q = np.array([sample[0] for sample in samples])
        inertia = hj.directional_inertia(robot, q, joint, H)
        flux = hj.hitting_flux(inertia, MASS, hj.hitting_speed(robot, q, joint, H))
        theirs = [sample[1:] for sample in samples]
        wrong = placed(robot, joint, points)(q)
        wrong = wrong or near(np.column_stack((inertia, flux)), EXACT)(theirs)
        if wrong:
            return wrong
    return ""
