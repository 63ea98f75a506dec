"""Swings for random hits of five arms: how many can be sent, what they deliver, what they cost.

`python -m benchmarks.swings 20` makes 20 hits for each arm, judged by `swing_checker`.
"""

from __future__ import annotations

import sys
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

import hitjoints as hj
from hitjoints.built import kernel_for
from hitjoints.hit import Hit
from hitjoints.model.robot import Robot
from hitjoints.planning.room.shapes import scene_of
from hitjoints.quantities import place_joint
from hitjoints.swings.make_swing import swing
from hitjoints.swings.swing_record import Swing
from tests.oracles.swing_checker import judge

SIZE = np.array([0.1, 0.1, 0.1])
MARGIN = 0.005
STATED = {"xarm7": 10.0, "ur5": 10.0}
"""rad/s^2, for arms that tell no acceleration limits: an assumption of this benchmark."""
NAMED = (
    "unreachable",
    "no reachable run-up",
    "no clear configuration",
    "a flux of",
    "no configuration moves",
)


def ur5() -> Path:
    """Return the URDF of the UR5 in the wheel of example-robot-data."""
    spec = find_spec("cmeel")
    assert spec is not None
    assert spec.submodule_search_locations is not None
    site = Path(next(iter(spec.submodule_search_locations))).parent
    folder = site / "cmeel.prefix/share/example-robot-data/robots/ur_description/urdf"
    return folder / "ur5_robot.urdf"


def arms() -> dict[str, Robot]:
    """Return the five arms by name."""
    names = ("iiwa14", "iiwa7", "panda", "xarm7")
    return {name: hj.load_robot(name) for name in names} | {"ur5": hj.load_robot(str(ur5()))}


def random_hits(robot: Robot, count: int, seed: int) -> Iterator[Hit]:
    """Yield hits with the last three joints, where a random configuration holds them."""
    rng = np.random.default_rng(seed)
    for i in range(count):
        joint = robot.n - 2 + i % 3
        position = hj.position(robot, rng.uniform(*robot.finite_limits), joint)
        mass = float(rng.uniform(0.5, 4.0))
        yield Hit(joint, position, rng.standard_normal(3), mass, size=SIZE)


def static_maximum(robot: Robot, hit: Hit, seed: int = 1) -> float:
    """Return the greatest straight flux of 1,500 clear configurations, wherever it comes from."""
    contact = robot.contact(hit.chosen_contact)
    placed = place_joint(robot, contact, np.tile(hit.position, (1500, 1)), seed)
    q = placed.q[placed.solved]
    if not len(q):
        return 0.0
    flux = kernel_for(robot, (contact,), ("straight_flux",))(q, hit.direction, hit.mass)
    scene = scene_of(robot)
    for row in np.argsort(-flux["straight_flux"][0]):
        box = scene.place_box(q[row], contact, hit.direction, SIZE, _axes(hit.direction))
        if min(scene.own_distance(q[row])[0], scene.distance(*box)[0]) >= MARGIN:
            return float(flux["straight_flux"][0][row])
    return 0.0


def _axes(h: Any) -> Any:
    across = np.cross([0.0, 0.0, 1.0], h)
    across /= np.linalg.norm(across)
    return np.column_stack((h, across, np.cross(h, across)))


@dataclass
class Tally:
    """What became of the hits of one arm."""

    asked: int = 0
    sendable: int = 0
    named: Counter[str] = field(default_factory=Counter)
    failed: Counter[str] = field(default_factory=Counter)
    wrong: Counter[str] = field(default_factory=Counter)
    times: list[float] = field(default_factory=list)
    shares: list[float] = field(default_factory=list)
    strikes: list[dict[str, Any]] = field(default_factory=list)
    durations: list[float] = field(default_factory=list)
    rollouts: Counter[str] = field(default_factory=Counter)


def run(name: str, robot: Robot, count: int, seed: int, *, roll: bool) -> Tally:
    """Make, judge and count the swings of one arm: the greatest flux, then a share of it."""
    tally, rng = Tally(), np.random.default_rng(seed)
    acceleration = None if robot.acceleration is not None else STATED[name]
    for hit in random_hits(robot, count, seed):
        share = float(rng.uniform(0.3, 0.9))
        fastest = attempt(tally, robot, hit, acceleration)
        if fastest is None:
            continue
        most = static_maximum(robot, hit)
        if most > 0:
            tally.shares.append(fastest.flux / most)
        wanted = hit.with_flux(share * fastest.flux)
        attempt(tally, robot, wanted, acceleration)
        if roll:
            try:
                rolled = hj.rollout(robot, wanted)
                tally.rollouts[rolled.reason.split(" ")[0] or "hit"] += 1
            except hj.HitjointsError:
                tally.rollouts["refused"] += 1
    return tally


def attempt(tally: Tally, robot: Robot, hit: Hit, acceleration: float | None) -> Swing | None:
    """Return a swing, judged and counted; None where there is none."""
    tally.asked += 1
    begin = time.process_time()
    try:
        made = swing(robot, hit, acceleration=acceleration, margin=MARGIN)
    except hj.InfeasibleError as error:
        tally.times.append(time.process_time() - begin)
        word = next((word for word in NAMED if error.reason.startswith(word)), "")
        (tally.named if word else tally.failed)[word or error.reason] += 1
        return None
    tally.times.append(time.process_time() - begin)
    found = judge(made, SIZE, MARGIN)
    tally.sendable += made.sendable
    tally.wrong.update(found["wrong"])
    tally.strikes.append(found)
    tally.durations.append(made.duration)
    return made


def report(name: str, tally: Tally) -> str:
    """Return the figures of an arm in words."""
    refused = sum(tally.named.values())
    share = tally.sendable / max(tally.asked - refused, 1)
    ms = 1e3 * np.array(tally.times)
    lines = [
        f"{name}: {tally.sendable} of {tally.asked - refused} sendable ({100 * share:.1f} %), "
        f"{refused} refused by name {dict(tally.named)}",
        f"  violations: {dict(tally.wrong)}; processor time {np.median(ms):.0f} ms, "
        f"95 % {np.percentile(ms, 95):.0f} ms; motions of {np.median(tally.durations):.2f} s",
    ]
    if tally.shares:
        median, low = np.median(tally.shares), np.percentile(tally.shares, 5)
        lines.append(f"  flux of the clear static maximum: median {median:.3f}, 5 % {low:.3f}")
    units = {"miss": "mm", "angle": "deg", "angle_before": "deg", "sideways": "mm"}
    for key, unit in units.items():
        scale = 1e3 if unit == "mm" else 1.0
        values = scale * np.array([its[key] for its in tally.strikes] or [np.nan])
        lines.append(f"  {key}: median {np.median(values):.3g}, most {values.max():.3g} {unit}")
    if tally.rollouts:
        lines.append(f"  rollouts of the same hits: {dict(tally.rollouts)}")
    lines += [f"  failed: {reason} ({count})" for reason, count in tally.failed.items()]
    return "\n".join(lines)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    COUNT = int([*sys.argv[1:], "20"][0])
    ONLY = sys.argv[2:]
    for arm_name, arm in arms().items():
        if not ONLY or arm_name in ONLY:
            print(report(arm_name, run(arm_name, arm, COUNT, seed=0, roll=True)), flush=True)
