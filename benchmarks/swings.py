"""Swings for random hits of five arms: how many can be sent, what they deliver, what they cost.

`python -m benchmarks.swings 200 --keep FILE` makes 200 hits for each arm, as hard as can be and
with a share of that; `swing_checker` judges the one and the other by turns. It keeps a line for
each hit: begun again, it goes on where it was. With names of arms it makes only theirs.
"""

from __future__ import annotations

import argparse
import json
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
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
from hitjoints.swings.strike_maker import StrikeMaker
from hitjoints.swings.swing_record import Swing
from tests.oracles.swing_checker import judge

SIZE = np.array([0.1, 0.1, 0.1])
MARGIN = 0.005
STATED = {"xarm7": 10.0, "ur5": 10.0}
"""rad/s^2, for arms that tell no acceleration limits: an assumption of this benchmark."""
STRAIGHTNESS = {"miss": "mm", "angle": "deg", "angle_before": "deg", "sideways": "mm"}
"""What the judge says of the contact at the impact and before it."""
LIMITED = 10
"""One in so many hits is also rolled out within the acceleration limits."""
NAMED = (
    "unreachable",
    "no reachable run-up",
    "no clear configuration",
    "the object is where the arm stands",
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


class Clock:
    """Processor time of a call, and of the last time that a motion was looked at densely."""

    def __init__(self) -> None:
        self._look, self._last = StrikeMaker.look, 0.0
        StrikeMaker.look = self._timed(StrikeMaker.look)  # type: ignore[method-assign]

    def _timed(self, look: Callable[..., Any]) -> Callable[..., Any]:
        def timed(*given: Any) -> Any:
            begin = time.process_time()
            found = look(*given)
            self._last = time.process_time() - begin
            return found

        return timed

    def __call__(self, make: Callable[[], Swing]) -> tuple[Swing | str, dict[str, float]]:
        """Return a swing or why there is none, and its seconds, with and without the last look."""
        self._last, begin = 0.0, time.process_time()
        try:
            made: Swing | str = make()
        except hj.InfeasibleError as error:
            made = error.reason
        whole = time.process_time() - begin
        return made, {"time": whole, "search_time": whole - self._last}


def asked(
    clock: Clock, robot: Robot, hit: Hit, acceleration: float | None, *, judged: bool
) -> dict[str, Any]:
    """Return what became of a hit."""
    made, times = clock(lambda: swing(robot, hit, acceleration=acceleration, margin=MARGIN))
    if isinstance(made, str):
        word = next((word for word in NAMED if made.startswith(word)), "")
        return {"named" if word else "failed": word or made, **times}
    found = judge(made, SIZE, MARGIN) if judged else {}
    told = {"sendable": made.sendable, "duration": made.duration, "flux": made.flux}
    return {**told, **times, **found}


def rolled(robot: Robot, hit: Hit, **kept: Any) -> dict[str, Any]:
    """Return what a rollout reaches of a hit."""
    try:
        run = hj.rollout(robot, hit, **kept)
    except hj.HitjointsError as error:
        return {"reason": "refused", "why": str(error), "share": 0.0, "acceleration": None}
    share = 0.0 if run.impact is None or hit.flux is None else run.impact.flux / hit.flux
    ratio = None if robot.acceleration is None else run.acceleration_ratio_max
    return {"reason": run.reason, "share": share, "acceleration": ratio, "sendable": run.sendable}


def results(name: str, robot: Robot, count: int, done: set[int]) -> Iterator[dict[str, Any]]:
    """Yield what became of hits: the greatest flux, a share of it, and rollouts of that share."""
    acceleration = None if robot.acceleration is not None else STATED[name]
    shares, clock = np.random.default_rng(0).uniform(0.3, 0.9, count), Clock()
    warm: set[int] = set()
    for index, hit in enumerate(random_hits(robot, count, 0)):
        if index in done:
            continue
        joint = hit.chosen_contact.joint
        if joint not in warm:
            clock(lambda hit=hit: swing(robot, hit, acceleration=acceleration))  # type: ignore[misc]
            warm.add(joint)
        fastest = asked(clock, robot, hit, acceleration, judged=index % 2 == 0)
        line = {"arm": name, "index": index, "fastest": fastest}
        if "flux" in fastest:
            wanted = hit.with_flux(float(shares[index]) * fastest["flux"])
            line["static"] = static_maximum(robot, hit)
            line["wanted"] = asked(clock, robot, wanted, acceleration, judged=index % 2 == 1)
            line["rollout"] = rolled(robot, wanted)
            if index % LIMITED == 0:
                kept = True if acceleration is None else acceleration
                line["limited"] = rolled(robot, wanted, acceleration_limits=kept)
        yield line


def report(name: str, lines: list[dict[str, Any]]) -> str:
    """Return the figures of an arm in words."""
    asks = [line[key] for line in lines for key in ("fastest", "wanted") if key in line]
    named = Counter(ask["named"] for ask in asks if "named" in ask)
    failed = Counter(ask["failed"] for ask in asks if "failed" in ask)
    struck = [ask for ask in asks if "flux" in ask]
    judged = [ask for ask in struck if "wrong" in ask]
    sendable, count = sum(ask["sendable"] for ask in struck), len(asks) - named.total()
    wrong = Counter(word for ask in judged for word in ask["wrong"])
    said = [
        f"{name}: {len(lines)} hits, {len(asks)} asked; {sendable} of {count} sendable "
        f"({100 * sendable / max(count, 1):.1f} %), {named.total()} refused by name {dict(named)}",
        f"  violations: {dict(wrong)} in {len(judged)} judged; processor time without the last "
        f"look {_spread(asks, 'search_time', 1e3)} ms, with it {_spread(asks, 'time', 1e3)} ms "
        f"(median, 95 %); motions of {_spread(struck, 'duration', 1.0)} s",
    ]
    shares = [x["fastest"]["flux"] / x["static"] for x in lines if x.get("static", 0) > 0]
    if shares:
        low = np.percentile(shares, (50, 5))
        said.append(f"  flux of the clear static maximum: median {low[0]:.3f}, 5 % {low[1]:.3f}")
    for key, unit in {
        "miss": "mm",
        "angle": "deg",
        "angle_before": "deg",
        "sideways": "mm",
    }.items():
        values = (1e3 if unit == "mm" else 1.0) * np.array([ask[key] for ask in judged] or [np.nan])
        said.append(f"  {key}: median {np.median(values):.3g}, most {values.max():.3g} {unit}")
    for key in ("rollout", "limited"):
        runs = [line[key] for line in lines if key in line]
        hits = [run for run in runs if not run["reason"]]
        harsh = [run["acceleration"] for run in hits if run["acceleration"] is not None]
        ends = Counter(run["reason"].split(" ")[0] for run in runs if run["reason"])
        said.append(
            f"  {key}: {len(hits)} of {len(runs)} hit, otherwise {dict(ends)}; accelerations "
            f"{np.median(harsh or [np.nan]):.3g} times the limits, most {max(harsh, default=0):.3g}"
        )
    said += [f"  failed: {reason} ({count})" for reason, count in failed.items()]
    return "\n".join(said)


def _spread(rows: list[dict[str, Any]], key: str, unit: float) -> str:
    values = unit * np.array([row[key] for row in rows] or [np.nan])
    return f"{np.median(values):.3g}, {np.percentile(values, 95):.3g}"


def main() -> None:
    """Read the command line, make what is not kept yet, and report."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.swings")
    parser.add_argument("count", type=int, nargs="?", default=20)
    parser.add_argument("arms", nargs="*")
    parser.add_argument("--keep", type=Path)
    parser.add_argument("--stated", type=float, help="rad/s^2, for arms that tell no limits")
    given = parser.parse_intermixed_args()
    if given.stated is not None:
        STATED.update(dict.fromkeys(STATED, given.stated))
    kept: list[dict[str, Any]] = []
    if given.keep is not None and given.keep.exists():
        kept = [json.loads(line) for line in given.keep.read_text().splitlines()]
    for name, robot in arms().items():
        if given.arms and name not in given.arms:
            continue
        lines = [line for line in kept if line["arm"] == name and line["index"] < given.count]
        for line in results(name, robot, given.count, {line["index"] for line in lines}):
            lines.append(line)
            if given.keep is not None:
                with given.keep.open("a") as file:
                    file.write(json.dumps(line) + "\n")
        print(report(name, lines), flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    main()
