"""Many quantities of one configuration in one call, for loops of every kind."""

from __future__ import annotations

import math
import threading
from collections import namedtuple
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.built import kernel_for, single_for
from hitjoints.dynamics.inertia import inertia_along
from hitjoints.errors import HitjointsError, InputError
from hitjoints.kernels.outputs import MASS, known_outputs
from hitjoints.kernels.tape.backends import choose
from hitjoints.vectors import positive_mass, unit

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import ArrayLike, NDArray

    from hitjoints.kernels.single import SingleKernel
    from hitjoints.model.robot import Contact, Robot

FLOAT = np.dtype(float)
NAMED: Any = namedtuple  # with fields that are known when one is made
HAVE_NO_LIMIT = frozenset({"inertia", "gradient"})
"""Outputs that do not exist where the contact cannot move along the direction."""
WORTH_COMPILING = 4000
"""Calls after which a quantity asked for one configuration at a time is compiled: by then they
have taken as long as compiling does."""


class Evaluator:
    """Quantities of one contact, bound to a robot: evaluated in a microsecond or two.

    The formulas are compiled when it is made, which takes a tenth of a second, and checked against
    Pinocchio. Threads may share it. Without llvmlite it gives the same answers, slowly.

    Args:
        robot: the arm.
        contact: joint number or Contact.
        outputs: names, see `hitjoints.kernels.Kernel`: "inertia", "gradient", "speed",
            "straight_speed", "flux", "straight_flux", "position", "jacobian", "mobility",
            "mobility_gradient", "response".
        mass: kg, of the object; for the fluxes.

    Raises:
        InputError: no such joint or output, no mass where one is needed, or a speed of an arm
            without velocity limits.
        KernelMismatchError: the compiled formulas disagree with Pinocchio.
    """

    def __init__(
        self,
        robot: Robot,
        contact: Contact | int,
        outputs: Sequence[str] = ("inertia", "gradient"),
        mass: float | None = None,
    ) -> None:
        names = (outputs,) if isinstance(outputs, str) else tuple(outputs)
        if not names:
            raise InputError("outputs", "()", "at least one is needed")
        if len(set(names)) < len(names):
            raise InputError("outputs", names, "each once")
        if mass is None and any(MASS in output.needs for output in known_outputs(names)):
            raise InputError("mass", None, "the flux needs the object's mass (kg)")
        self.robot, self.contact, self.outputs = robot, robot.contact(contact), names
        self.mass = 0.0 if mass is None else positive_mass(mass)
        self._make = NAMED("Evaluation", names)._make
        self._shape = (robot.n,)
        self._limited = not HAVE_NO_LIMIT.intersection(names)
        self._own: Any = None
        if choose() == "llvm":
            self._own = _Numbers(single_for(robot, self.contact, names), self.mass)

    def __reduce__(self) -> tuple[type[Evaluator], tuple[Any, ...]]:
        """Pickle what it was made of."""
        return type(self), (self.robot, self.contact, self.outputs, self.mass or None)

    def __call__(self, q: ArrayLike, direction: ArrayLike) -> Any:
        """Return a named tuple in the order of the outputs.

        Args:
            q: (n,) rad. Limits are not asked for.
            direction: (3,), of any length but zero.

        Returns:
            Floats and arrays, in the units and shapes of a kernel's outputs for one row.

        Raises:
            InputError: wrong shapes, or a number that is not finite.
            InfeasibleError: inertia or gradient are asked for and the contact cannot move along
                the direction. Speeds and fluxes are zero there.
        """
        own = self._own
        if (
            own is None
            or type(q) is not np.ndarray
            or q.dtype is not FLOAT
            or q.shape != self._shape
        ):
            return self._checked(q, direction)
        own.q[:] = q
        if type(direction) is np.ndarray and direction.dtype is FLOAT and direction.shape == (3,):
            own.h[:] = direction
        else:
            own.h[:] = self._direction(direction)
        own.run()
        status = own.status()
        if status == 2.0 or (status == 1.0 and self._limited):
            return self._make([part() for part in own.parts])
        return self._checked(q, direction)

    def _checked(self, q: ArrayLike, direction: ArrayLike) -> Any:
        """Return the same for input of every kind, or say what is wrong with it."""
        q, h = self.robot.one_configuration(q), self._direction(direction)
        own = self._own
        if own is None:
            if not self._limited:
                inertia_along(self.robot, q, self.contact, h)  # raises where there is none
            kernel = kernel_for(self.robot, (self.contact,), self.outputs)
            found = kernel(q[None, :], h, self.mass)
            values = [found[name][0, 0] for name in self.outputs]
            return self._make([v.copy() if v.ndim else float(v) for v in values])
        own.q[:], own.h[:] = q, h
        own.run()
        if own.status() == 1.0 and not self._limited:
            inertia_along(self.robot, q, self.contact, h)  # raises: the contact cannot move
        return self._make([part() for part in own.parts])

    def _direction(self, direction: ArrayLike) -> NDArray[np.float64]:
        h = unit(direction)
        if h.shape != (3,):
            raise InputError("direction", f"{len(h)} rows", "one direction")
        return h


class _Numbers(threading.local):
    """What a thread fills in, runs and reads; every thread gets its own."""

    def __init__(self, kernel: SingleKernel, mass: float) -> None:
        inputs, outputs, self.run = kernel.program.bind()
        n = kernel.joints
        self.q, self.h = inputs[:n], inputs[n : n + 3]
        inputs[n + 3] = mass
        self.status: Callable[[], float] = partial(outputs.item, 0)
        self.parts: list[Callable[[], Any]] = []
        start = 1
        for shape in kernel.shapes:
            stop = start + math.prod(shape)
            view = outputs[start:stop].reshape(shape)
            self.parts.append(view.copy if shape else view.item)
            start = stop


class Quick:
    """One quantity behind an ordinary function: compiled once it has been asked for often.

    Args:
        robot: the quantity.
        contact: the quantity.
        output: the quantity.
    """

    def __init__(self, robot: Robot, contact: Contact | int, output: str) -> None:
        self._asked: tuple[Robot, Contact | int, tuple[str]] = (robot, contact, (output,))
        self._calls = 0
        self._evaluator: Evaluator | None = None

    def __call__(self, q: ArrayLike, direction: ArrayLike) -> Any:
        """Return the quantity, or None: not yet, or not this way."""
        if self._evaluator is None:
            self._calls += 1
            if self._calls != WORTH_COMPILING or choose() != "llvm":
                return None
            try:
                self._evaluator = Evaluator(*self._asked)
            except HitjointsError:  # the ordinary way says what is wrong, or does without
                return None
        return self._evaluator(q, direction)[0]
