"""Search a swing: choose where and how to strike, wind up, get there, and stop."""

from __future__ import annotations

import math
from collections import Counter
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.quantities import place_joint
from hitjoints.swings.curves import Joints, Motion, Piece, Standing, Stroke
from hitjoints.swings.hit_samples import Samples, draw, folded, measured, spread_out
from hitjoints.swings.impact_state import impact_velocity
from hitjoints.swings.motion_limits import greatest_ratios, torques
from hitjoints.swings.stroke_search import RUN_UP, FoundStroke, StrokeSearch
from hitjoints.swings.swing_record import Swing
from hitjoints.swings.way_there import way_there

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.hit import Hit
    from hitjoints.hitting.drive_limits import DriveLimits
    from hitjoints.model.robot import Robot
    from hitjoints.swings.clear_way import Obstacle, Room
    from hitjoints.types import Array

CANDIDATES = 40
"""Configurations whose strokes are looked at."""
SIZE = (0.1, 0.1, 0.1)
"""m, edges of the object where none are given."""
HOLDING = 0.95
"""Share of the torque limits that gravity may take at the impact."""
TIERS = (0.999, 0.99, 0.975, 0.95, 0.92, 0.88, 0.83, 0.77, 0.7, 0.6, 0.5, 0.4, 0.3)
"""Shares of the greatest flux that are tried where no flux is asked for,"""
FEW, ALL = 12, 120
"""from so many configurations each, and so many all in all."""
SHORT = 0.996
"""Share of the flux asked for that counts as that: what is asked may be a rounded maximum."""
AT_THE_OBJECT = 1e-4
"""m, how far from the object a given configuration may hold the contact."""
SLOWEST, TOO_SLOW = 5e-3, "slower than 5 mm/s"
"""m/s, less speed at the impact would take minutes of winding up."""
ALWAYS = {"not clear at the impact", "gravity"}
"""Reasons against a configuration, whatever the stroke."""
STARTS = 100
"""Attempts at placing the contact behind the object."""


class SwingSearch:
    """Searches a swing of one arm for one hit.

    Args:
        robot: the arm and the hit.
        hit: the arm and the hit.
        limits: of its drives.
        room: what is around.
        start: (n,) rad, where the arm is.
        dt: s, spacing of the samples.
        seed: of the samples.
    """

    def __init__(
        self,
        robot: Robot,
        hit: Hit,
        limits: DriveLimits,
        room: Room,
        start: Array,
        dt: float,
        seed: int,
    ) -> None:
        self.robot, self.hit, self.limits, self.room = robot, hit, limits, room
        self.start, self.dt, self.rng = start, dt, np.random.default_rng(seed)
        self.seed = seed
        self.contact = robot.contact(hit.chosen_contact)
        self.size = np.array(SIZE) if hit.size is None else hit.size
        self.search = StrokeSearch(robot, hit, limits, room)
        self.reasons: Counter[str] = Counter()
        self.notes: list[str] = []
        self.seen: dict[int, tuple[Obstacle | None, str]] = {}
        self.best, self.struck = 0.0, 0

    def swing(self, q_hit: ArrayLike | None) -> Swing:
        """Return the swing, from q_hit (n,) rad if it can be.

        Raises:
            InputError, InfeasibleError: as `swing`.
        """
        self._check_start()
        drawn = draw(self.robot, self.hit, self.limits, self.start, self.seed)
        if q_hit is not None:
            first = folded(self.robot, self._at_object(q_hit)[None], self.start)
            drawn = np.concatenate((first, drawn))
        self._check_run_up()
        samples = measured(self.robot, self.hit, self.limits, drawn)
        self.best = float(samples.flux.max(initial=0.0))
        wanted = self.hit.flux
        if not self.best > 0:
            raise InfeasibleError("no configuration moves straight along the direction")
        if wanted is not None and wanted * SHORT > self.best:
            raise InfeasibleError(
                f"a flux of {wanted:.4g} m/s is beyond the maximum of {self.best:.4g} m/s that can "
                f"be delivered from rest with joint {self.contact.joint} at the object",
                {"maximum_flux": self.best, "flux": wanted},
            )
        if q_hit is not None:
            if samples.flux[0] >= SHORT * (wanted or 0.0):
                found = self._from(samples, np.array([0]), wanted, 1)
                if found is not None:
                    return found
            reason = ", ".join(self.reasons) or f"it delivers {samples.flux[0]:.3g} m/s at most"
            self.notes.append(f"no swing from the q_hit asked for ({reason}): another is taken")
        asked = [wanted] if wanted is not None else [share * self.best for share in TIERS]
        for flux in asked:
            among = np.flatnonzero(samples.flux >= SHORT * flux)
            found = self._from(samples, among, flux, FEW if len(asked) > 1 else CANDIDATES)
            if found is not None:
                return found
        raise self._refusal(wanted)

    def _check_start(self) -> None:
        seen = self.room.check(self.start[None], None)
        if seen.row is not None:
            expected = f"{seen.what} are {seen.least:.3g} m apart there"
            raise InputError("q0", self.start.round(4).tolist(), expected)

    def _at_object(self, q: ArrayLike) -> Array:
        q = self.robot.within_limits(q, "q_hit")
        off = float(np.linalg.norm(position(self.robot, q, self.contact) - self.hit.position))
        if off > AT_THE_OBJECT:
            expected = f"it holds the contact {off:.3g} m off the object"
            raise InputError("q_hit", q.round(4).tolist(), expected)
        return np.array(place_joint(self.robot, self.contact, self.hit.position, start=q).q[0])

    def _check_run_up(self) -> None:
        """Refuse a hit for which the contact cannot begin far enough behind the object."""
        behind = self.hit.position - RUN_UP * self.hit.direction
        placed = place_joint(self.robot, self.contact, np.tile(behind, (STARTS, 1)), self.seed)
        if not placed.solved.any():
            raise InfeasibleError(
                f"no reachable run-up: joint {self.contact.joint} comes no nearer than "
                f"{placed.error.min():.3g} m to the point {100 * RUN_UP:g} cm behind the object",
                {"joint": self.contact.joint, "nearest": float(placed.error.min())},
            )

    def _from(
        self, samples: Samples, chosen: NDArray[np.intp], wanted: float | None, most: int
    ) -> Swing | None:
        looked = 0
        for row in spread_out(self.robot, self.hit, samples, chosen, self.start):
            box, reason = self._clear(int(row), samples.q[row])
            if reason:
                self.reasons[reason] += 1
                continue
            looked += 1
            if looked > most or self.struck >= ALL:
                break
            self.struck += 1
            found = self._strike(samples, int(row), wanted, box)
            if found is not None:
                return found
        return None

    def _clear(self, row: int, q: Array) -> tuple[Obstacle | None, str]:
        """Return the object as it is hit in a configuration, or what is in the way there."""
        if row not in self.seen:
            box, reason = None, ""
            gravity = pin.computeGeneralizedGravity(self.robot.model, self.robot.data, q)
            if (np.abs(gravity) > HOLDING * self.limits.effort).any():
                reason = "gravity"
            elif self.room.check(q[None], None).row is not None:
                reason = "not clear at the impact"
            else:
                box = self.room.box(q, self.contact, self.hit.direction, self.size, self.hit.yaw)
                if self.room.check(q[None], box).row is not None:
                    reason = "not clear at the impact"
            self.seen[row] = box, reason
        return self.seen[row]

    def _strike(
        self, samples: Samples, row: int, wanted: float | None, box: Obstacle | None
    ) -> Swing | None:
        most = (1.0 - 1e-9) * float(samples.flux[row])
        share = float(samples.inertia[row] / (samples.inertia[row] + self.hit.mass))
        speed = (most if wanted is None else min(wanted, most)) / share
        if speed < SLOWEST:
            self.reasons[TOO_SLOW] += 1
            return None
        J, ends = samples.J[row], (samples.lower[row], samples.upper[row])
        qd = impact_velocity(J, self.hit.direction, *ends, speed)
        if qd is None:
            self.reasons["no certified velocity"] += 1
            return None
        strike = FoundStroke(samples.q[row], qd, J, speed)
        for stroke, reason in self.search.strokes(strike, box):
            whole = reason or self._whole(stroke, box)
            if not isinstance(whole, str):
                return whole
            self.reasons[whole] += 1
            if whole.startswith("way there"):
                break
        return None

    def _whole(self, stroke: Stroke, box: Obstacle | None) -> Swing | str:
        """Return the swing with this stroke, or what is in its way."""
        if not self._kept(stroke.at(stroke.corners)):
            return "limits, where a ramp is short"
        way = way_there(
            self.robot,
            self.limits,
            self.room,
            self.room.whole(box),
            self.start,
            stroke.start,
            self.rng,
        )
        if isinstance(way, str):
            return way
        before = sum(line.duration for line in way) + stroke.impact
        sample = math.ceil(before / self.dt - 1e-6)
        # The arm waits at first, so that the impact falls on a sample.
        waiting = Standing(self.start, max(sample * self.dt - before, 0.0))
        pieces: list[Piece] = [waiting, *way, stroke]
        whole = sum(piece.duration for piece in pieces)
        ended = math.ceil(whole / self.dt - 1e-6) + 1
        motion = Motion([*pieces, Standing(stroke.end, ended * self.dt - whole)])
        return self._checked(motion, sample, box)

    def _kept(self, joints: Joints) -> bool:
        """Tell whether positions, their derivatives and torques are within limits."""
        robot, limits = self.robot, self.limits
        inside = ((joints.q >= robot.lower) & (joints.q <= robot.upper)).all()
        if not inside or max(greatest_ratios(limits, joints)) > 1.0:
            return False
        return bool((np.abs(torques(robot, limits, joints)) <= limits.effort).all())

    def _checked(self, motion: Motion, sample: int, box: Obstacle | None) -> Swing | str:
        """Look at a whole motion densely: at every sample and between them."""
        robot, limits = self.robot, self.limits
        step = min(self.dt, 1e-3) / 2
        times: Array = step * np.arange(int(motion.duration / step) + 1.0)
        joints = motion.at(times)
        if max(greatest_ratios(limits, joints)) > 1.0:
            return "limits, looked at densely"
        if ((joints.q < robot.lower) | (joints.q > robot.upper)).any():
            return "position limits, looked at densely"
        if (np.abs(torques(robot, limits, joints)) > limits.effort).any():
            return "torque, looked at densely"
        hit = round(sample * self.dt / step)
        before = self.room.check(joints.q[: hit + 1], box)
        after = self.room.check(joints.q[hit:], None)
        least = min(before, after, key=lambda seen: seen.least)
        if before.row is not None or after.row is not None:
            return "collision, looked at densely"
        found = Swing(
            robot,
            self.hit,
            limits,
            motion,
            self.dt,
            sample,
            least.least if self.room.known else None,
            least.what,
            self.best,
            dict(self.reasons),
            tuple(self.notes),
        )
        return found if found.sendable else found.why

    def _refusal(self, wanted: float | None) -> InfeasibleError:
        data = {"tried": dict(self.reasons), "maximum_flux": self.best}
        if TOO_SLOW in self.reasons and set(self.reasons) <= {TOO_SLOW, *ALWAYS}:
            return InfeasibleError(f"the contact would move {TOO_SLOW}: ask for more flux", data)
        if set(self.reasons) <= ALWAYS:
            return InfeasibleError(
                f"no clear configuration: the arm touches the object, the table or itself in all "
                f"{sum(self.reasons.values())} that could deliver it",
                data,
            )
        common = ", ".join(f"{word} ({count})" for word, count in self.reasons.most_common(3))
        what = "any flux" if wanted is None else f"{wanted:.4g} m/s"
        return InfeasibleError(f"no stroke found that delivers {what}: {common}", data)
