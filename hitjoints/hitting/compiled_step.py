"""A control step as a compiled call: an answer that is proved right, or none."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import chain_of, refused_by_name
from hitjoints.errors import KernelMismatchError
from hitjoints.hitting.step import SLOWED, Step
from hitjoints.hitting.step_tape import Setting, record_step_of
from hitjoints.kernels.reference import PinocchioAnswers
from hitjoints.kernels.tape.backends import choose
from hitjoints.kernels.verify import samples

if TYPE_CHECKING:
    from hitjoints.kernels.tape.scalar import ScalarProgram
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.types import Array

FLOAT = np.dtype(float)
GUESSES = 24
"""Guesses of the active bounds that are followed; the right one is mostly the last step's."""
HASTY = 5
"""Of these change in all entries at once; the rest, which may have run in a circle, one by one."""
AGREES = 1e-9
"""Largest deviation from Pinocchio, relative to 1 plus the size."""


class CompiledStep:
    """Takes steps with the settings of one controller; not for several threads at once.

    Every answer meets the optimality conditions of both programs for the bounds that it takes to
    be active. Where no such answer is found in a few guesses, or an arm is singular, at its limits
    or beyond, there is none.

    Args:
        robot: the arm and what it hits with.
        contact: the arm and what it hits with.
        setting: of the controller, numbers in place of a tape's.
    """

    def __init__(self, robot: Robot, contact: Contact, setting: Setting) -> None:
        n = robot.n
        self._inputs, self._outputs, self._run = program_for(robot, contact).bind()
        self._q, self._shape = self._inputs[:n], (n,)
        self._guesses = self._inputs[n : 3 * n + 1]
        self._next = self._outputs[3 : 2 * n + 4]
        self._inputs[3 * n + 1 : -1] = _flat(setting)
        self._status = self._outputs[:3]
        self._qd = self._outputs[2 * n + 4 : 3 * n + 4]
        self._position = self._outputs[3 * n + 5 : 3 * n + 8]
        self._scaling = 3 * n + 4
        self._numbers = self._outputs[3 * n + 8 : 3 * n + 13]
        self._begin()

    def __call__(self, q: Any) -> Step | None:
        """Return the step from q (n,) rad, or None: not this way."""
        if type(q) is not np.ndarray or q.dtype is not FLOAT or q.shape != self._shape:
            return None
        self._q[:] = q
        self._inputs[-1] = 0.0
        for guess in range(GUESSES):
            self._run()
            usable, exact, changed = self._status.tolist()
            if not usable > 0.0:
                break
            if changed == 0.0:
                if not exact > 0.0:
                    break
                scaling = self._outputs.item(self._scaling)
                inertia, desired, speed, flux, beyond = self._numbers.tolist()
                return Step(
                    self._qd.copy(),
                    self._position.copy(),
                    inertia,
                    desired,
                    speed,
                    flux,
                    scaling,
                    beyond > 0.0 or scaling < SLOWED,
                    False,
                    False,
                )
            self._guesses[:] = self._next
            if guess == HASTY:
                self._inputs[-1] = 1.0
        self._begin()
        return None

    def _begin(self) -> None:
        """Guess that no bound is active but s = 1."""
        self._guesses[:] = 0.0
        self._guesses[-1] = 1.0


def compiles() -> bool:
    """Tell whether steps can be compiled here."""
    return choose() == "llvm"


@lru_cache(maxsize=16)
def program_for(robot: Robot, contact: Contact) -> ScalarProgram:
    """Return the compiled step of a robot and a contact, checked against Pinocchio.

    Raises:
        KernelMismatchError: its kinematics or inertias disagree.
        ModelError: a joint carries no inertia.
    """
    from hitjoints.kernels.tape.scalar import ScalarProgram  # which needs llvmlite

    chain = chain_of(robot)
    attached = chain.attach(contact.joint, contact.offset)
    with refused_by_name(robot):
        program = ScalarProgram(record_step_of(chain, attached))
    inputs, outputs, run = program.bind()
    n, data = robot.n, robot.model.createData()
    where = (contact.joint, contact.offset)
    for q, h, mass in zip(*samples(robot.model), strict=True):
        answers = PinocchioAnswers(robot.model, data, q, where, h, float(mass))
        if not answers.moves:
            continue
        setting = Setting(
            (0.0, 0.0, 0.0), tuple(h), mass, 0.1, 0.002, 1.0, 0.0, 0.5, 0.5, 0.0, 0.0, tuple(q)
        )
        inputs[:n], inputs[n : 3 * n + 1], inputs[3 * n + 1 : -1] = q, 0.0, _flat(setting)
        run()
        position, inertia = outputs[3 * n + 5 : 3 * n + 8], outputs[3 * n + 8]
        for name, found, expected in (
            ("position", position, answers.position),
            ("inertia", inertia, answers.inertia),
            ("gradient", outputs[3 * n + 13 :], answers.gradient),
        ):
            size = 1.0 + float(np.abs(expected).max()) + answers.inertia
            deviation = float(np.abs(found - expected).max())
            if not deviation <= AGREES * size:
                raise KernelMismatchError(
                    f"{name} of a control step at joint {contact.joint}: off by {deviation:.3g} "
                    "from Pinocchio"
                )
    return program


def _flat(setting: Setting) -> Array:
    target, direction, *rest, posture = setting
    return np.array([*target, *direction, *rest, *posture], dtype=float)
