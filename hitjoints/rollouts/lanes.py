"""Many rollouts of one contact side by side, a step of all of them at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from hitjoints.errors import InfeasibleError
from hitjoints.hitting.approach import STILL, before_it, most_steps, steps_of_patience
from hitjoints.hitting.controller import Controller
from hitjoints.hitting.step import SLOWED
from hitjoints.hitting.step_layout import flat, unbounded
from hitjoints.hitting.step_rows import step_rows_for
from hitjoints.hitting.step_tape import Setting

if TYPE_CHECKING:
    from typing import Literal

    from numpy.typing import NDArray

    from hitjoints.hitting.controller import ReferenceName
    from hitjoints.hitting.desired import Weighting
    from hitjoints.hitting.step import Gains
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.rollouts.many_starts import Starts
    from hitjoints.rollouts.tallies import Tallies
    from hitjoints.types import Array


class Way(NamedTuple):
    """How the arms are controlled, see `Controller`."""

    dt: float
    reference: ReferenceName
    weighting: Weighting
    gains: Gains
    speed_profile: Literal["paper", "constant"]


@dataclass(eq=False)
class Approaches:
    """What N ways to the object come to.

    Attributes:
        steps: (N,) taken.
        saturated_steps: (N,) of these.
        braked_steps: (N,) of these.
        certified_steps: (N,) of these, which had no compiled answer.
        reason: (N,) why the object is not reached; empty if it is.
        before: (n, N) rad, where the last step began.
        after: (n, N) rad, where it ended.
        saturated: (N,) that step.
    """

    steps: NDArray[np.int64]
    saturated_steps: NDArray[np.int64]
    braked_steps: NDArray[np.int64]
    certified_steps: NDArray[np.int64]
    reason: list[str]
    before: Array
    after: Array
    saturated: NDArray[np.bool_]


class Lanes:
    """Rollouts of one contact, all with the same steps in time.

    Args:
        robot: the arm.
        contact: what it hits with.
        starts: of the rollouts, N of them.
        way: how they are controlled.
    """

    def __init__(self, robot: Robot, contact: Contact, starts: Starts, way: Way) -> None:
        self.robot, self.starts, self.way = robot, starts, way
        self.step = step_rows_for(robot, contact)
        self._settings = np.array([flat(self._setting(i)) for i in range(len(starts.hits))]).T
        self._controllers: dict[int, Controller] = {}

    def inputs(self, rows: NDArray[np.int64], q: Array) -> Array:
        """Return the inputs of a first step of some rollouts from q (n, M) rad."""
        at = self.step.at
        inputs = np.zeros((self.step.run.program.inputs, len(rows)))
        inputs[at.q], inputs[at.guesses] = q, self.step.first[:, None]
        inputs[at.setting] = self._settings[:, rows]
        unbounded(inputs, at)
        return inputs

    def approach(self, tallies: Tallies) -> Approaches:
        """Move all of them until the object is reached, or there is a reason against it."""
        starts, way, at = self.starts, self.way, self.step.at
        found = self._nothing_yet()
        rows = np.flatnonzero([not reason for reason in starts.refused])
        target, h = starts.target.T, starts.direction.T
        inputs = self.inputs(rows, starts.q0[rows].T)
        still, patience = np.zeros(len(starts.hits), dtype=np.int64), steps_of_patience(way.dt)
        most = np.array(self._most_steps(), dtype=np.int64)
        last = np.zeros((4, len(starts.hits)))  # position and needed speed of the step before
        count = 0
        while rows.size:
            outputs, right = self.step(inputs)
            here, keep = outputs[at.position], np.ones(rows.size, dtype=np.bool_)
            if count:
                ahead = ((target[:, rows] - here) * h[:, rows]).sum(axis=0)
                moved = np.sqrt(((here - last[:3, rows]) ** 2).sum(axis=0)) / way.dt
                still[rows] = np.where(moved < STILL * last[3, rows], still[rows] + 1, 0)
                stalled, late = still[rows] >= patience, most[rows] <= count
                keep = (ahead > 0) & ~stalled & ~late
                for i in np.flatnonzero(~keep & (ahead > 0)).tolist():
                    row, how = rows[i], "stalled" if stalled[i] else "out of time"
                    text = before_it(how, ahead[i], self.robot, found.after[:, row])
                    found.reason[row] = text
            for i in np.flatnonzero(keep & ~right).tolist():
                keep[i] = self._certified(rows[i], outputs[:, i], found, tallies)
            if not keep.all():
                rows, inputs, outputs = rows[keep], inputs[:, keep], outputs[:, keep]
            self._advance(rows, inputs, outputs, found, tallies)
            last[:3, rows] = outputs[at.position]
            inertia = outputs[at.numbers][0]
            last[3, rows] = (1.0 + starts.mass[rows] / inertia) * starts.flux[rows]
            count += 1
        return found

    def desired_inertia(self, row: int, q: Array, qd: Array) -> float:
        """Return what a rollout aims for at q (n,) rad, by the certifying way."""
        control = self._controller(row)
        control.step(q, qd)
        assert control.last is not None
        return control.last.desired_inertia

    def _advance(
        self,
        rows: NDArray[np.int64],
        inputs: Array,
        outputs: Array,
        found: Approaches,
        tallies: Tallies,
    ) -> None:
        """Go along the steps taken, and note them."""
        at, robot = self.step.at, self.robot
        q, qd = inputs[at.q].copy(), outputs[at.qd]
        tallies.add(rows, q, qd)
        found.steps[rows] += 1
        found.saturated[rows] = (outputs[at.numbers][4] > 0) | (outputs[at.scaling] < SLOWED)
        found.saturated_steps[rows] += found.saturated[rows]
        ahead = np.clip(q + self.way.dt * qd, robot.lower[:, None], robot.upper[:, None])
        found.before[:, rows], found.after[:, rows], inputs[at.q] = q, ahead, ahead

    def _certified(self, row: int, outputs: Array, found: Approaches, tallies: Tallies) -> bool:
        """Take a step the certifying way, write it over the outputs, and tell whether it exists."""
        at, control = self.step.at, self._controller(row)
        q = found.after[:, row]
        try:
            outputs[at.qd] = control.step(q, tallies.qd[:, row])
        except InfeasibleError as error:
            singular = "direction" in error.data
            found.reason[row] = f"singular: {error.reason}" if singular else error.reason
            return False
        step = control.last
        assert step is not None
        outputs[at.position] = step.position
        outputs[at.numbers] = (*step[2:6], float(step.saturated))
        outputs[at.scaling] = 1.0
        found.certified_steps[row] += 1
        found.braked_steps[row] += step.braked
        return True

    def _controller(self, row: int) -> Controller:
        if row not in self._controllers:
            starts, way = self.starts, self.way
            self._controllers[row] = Controller(
                self.robot,
                starts.hits[row],
                starts.q_hit[row],
                inertia=float(starts.inertia[row]),
                posture=starts.posture[row],
                compiled=False,
                **way._asdict(),
            )
        return self._controllers[row]

    def _setting(self, row: int) -> Setting:
        starts, way = self.starts, self.way
        return Setting(
            tuple(starts.target[row]),
            tuple(starts.direction[row]),
            starts.mass[row],
            starts.flux[row],
            way.dt,
            way.speed_profile == "constant",
            way.weighting == "gradient",
            *way.gains,
            way.reference == "constant",
            starts.inertia[row] if way.reference == "constant" else 0.0,
            tuple(starts.posture[row]),
        )

    def _most_steps(self) -> list[int]:
        pairs = zip(self.starts.ahead.tolist(), self.starts.flux.tolist(), strict=True)
        return [most_steps(ahead, flux, self.way.dt) for ahead, flux in pairs]

    def _nothing_yet(self) -> Approaches:
        count = len(self.starts.hits)
        steps, saturated, braked, certified = np.zeros((4, count), dtype=np.int64)
        q0, still = self.starts.q0.T, np.zeros(count, dtype=np.bool_)
        reason = list(self.starts.refused)
        return Approaches(steps, saturated, braked, certified, reason, q0.copy(), q0.copy(), still)
