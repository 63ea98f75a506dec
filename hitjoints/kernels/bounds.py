"""Rigorous bounds of hitting quantities over boxes of configurations."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pinocchio as pin

from hitjoints.errors import InputError
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.formulas.hit_formulas import Attachment, record_variation
from hitjoints.kernels.kernel import Kernel, build_kernel
from hitjoints.kernels.outputs import record
from hitjoints.kernels.tape import interval_backend as ia
from hitjoints.kernels.tape.backends import over_boxes
from hitjoints.kernels.tape.interval_backend import Array, Interval
from hitjoints.tolerances import MOBILITY_FLOOR


class InertiaBounds:
    """Bounds of the mobility of one contact, each of three kinds, and of its inverse.

    The natural extension is sharp for points; the mean value form m(c) + dm(Q) (Q - c) for small
    boxes. For the lower bound of the mobility 2 g . u - u^T M u with u fixed at the box's centre
    does better: no factor of M over intervals, and its derivative varies little.

    Args:
        chain: the arm.
        contact: as `Chain.attach` returns it.
        centre: kernel with the outputs mobility and response, for the same contact at `index`.
        index: which of the kernel's contacts.
    """

    def __init__(self, chain: Chain, contact: Attachment, centre: Kernel, index: int) -> None:
        self.natural = over_boxes(record(chain, [contact], ("mobility", "mobility_gradient")))
        self.variation = over_boxes(record_variation(chain, contact))
        self.centre, self.index = centre, index

    def __call__(self, box: Interval, h: Array, threads: int | None) -> Interval:
        """Bounds (B,) of the inertia (kg) where the contact can move, infinite above where its
        mobility may vanish.
        """
        middle = 0.5 * (box.lower + box.upper)
        count = len(middle)
        response = self.centre(middle, h, threads=threads)["response"][self.index]
        point = _columns(Interval(middle, middle))
        direction, u = _shared(h), _columns(Interval(response, response))
        unused = _shared(np.zeros((1, 1)))
        whole = self.natural([*_columns(box), *direction, *unused], count)
        at_middle = self.natural([*point, *direction, *unused], count)
        value = self.variation([*point, *direction, *u], count)
        slope = self.variation([*_columns(box), *direction, *u], count)
        with np.errstate(invalid="ignore", over="ignore"):
            offset = [ia.subtract(a, b) for a, b in zip(_columns(box), point, strict=True)]
            mean = _mean_value(_row(at_middle, 0), whole, offset)
            variational = _mean_value(_row(value, 0), slope, offset)
        natural = _row(whole, 0)
        lower = np.fmax(np.fmax(natural.lower, mean.lower), np.fmax(variational.lower, 0.0))
        upper = np.fmin(natural.upper, mean.upper)
        with np.errstate(divide="ignore"):
            return Interval(
                np.nextafter(1.0 / np.maximum(upper, MOBILITY_FLOOR), 0.0),
                np.where(lower > MOBILITY_FLOOR, np.nextafter(1.0 / lower, np.inf), np.inf),
            )


class Bounds:
    """Bounds over boxes, made by `build_bounds`.

    Args:
        kernel: the point kernel for the same contacts, with mobility and response.
        natural: program of the outputs.
        inertia: sharper bounds of the inertia, one per contact, if asked for.
        outputs: names of the results.
    """

    def __init__(
        self,
        kernel: Kernel,
        natural: Callable[[list[Interval], int], Interval],
        inertia: list[InertiaBounds],
        outputs: tuple[str, ...],
    ) -> None:
        self.kernel, self.natural, self.inertia, self.outputs = kernel, natural, inertia, outputs

    def __call__(
        self,
        lower: Array,
        upper: Array,
        direction: Array,
        mass: float = 0.0,
        threads: int | None = None,
    ) -> dict[str, Interval]:
        """Bound every output over every box; they hold for the kernels' rounded results, too.

        Args:
            lower: (B, n) least configurations (rad, m).
            upper: (B, n) greatest configurations.
            direction: (3,) unit vector in the world.
            mass: object's mass (kg).
            threads: for the points in the middle.

        Returns:
            Per output lower and upper bounds, each shaped as a kernel's result for B rows.

        Raises:
            InputError: shapes do not fit, or lower > upper.
        """
        box = Interval(np.asarray(lower, dtype=np.float64), np.asarray(upper, dtype=np.float64))
        expected = (len(box.lower), self.kernel.joints)
        if box.lower.shape != expected or box.upper.shape != expected:
            raise InputError("upper", f"shape {box.upper.shape}", f"{expected} is expected")
        if not np.all(box.lower <= box.upper):
            raise InputError("lower", "a row", "at most `upper` is expected")
        h = np.asarray(direction, dtype=np.float64)
        if h.shape != (3,):
            raise InputError("direction", f"shape {h.shape}", "(3,) is expected")
        inputs = [*_columns(box), *_shared(h), *_shared(np.full((1, 1), mass))]
        natural = self.natural(inputs, len(box.lower))
        low, high = (self.kernel.named(bound, self.outputs) for bound in natural)
        results = {name: Interval(low[name], high[name]) for name in self.outputs}
        if self.inertia:
            sharp = [bounds(box, h, threads) for bounds in self.inertia]
            results["inertia"] = Interval(
                np.maximum(results["inertia"].lower, [one.lower for one in sharp]),
                np.minimum(results["inertia"].upper, [one.upper for one in sharp]),
            )
        return results


def build_bounds(
    model: pin.Model,
    contacts: Sequence[tuple[int, Sequence[float]]],
    outputs: Sequence[str] = ("inertia",),
    backend: str | None = None,
) -> Bounds:
    """Make the outputs ready for boxes.

    Args:
        model: serial fixed-base arm.
        contacts: 1-based joint and contact point in the joint's frame (m).
        outputs: see `Kernel.__call__`; inertia is bounded most sharply.
        backend: for the points in the middle of the boxes, see `build_kernel`.

    Raises:
        InputError, ModelError, KernelMismatchError: as `build_kernel`.
    """
    kernel = build_kernel(model, contacts, ("mobility", "response"), backend)
    chain = Chain.from_model(model)
    attached = [chain.attach(*contact) for contact in kernel.contacts]
    natural = over_boxes(record(chain, attached, tuple(outputs)))
    inertia = [
        InertiaBounds(chain, contact, kernel, k)
        for k, contact in enumerate(attached)
        if "inertia" in outputs
    ]
    return Bounds(kernel, natural, inertia, tuple(outputs))


def bisect(lower: Array, upper: Array, scale: Array | None = None) -> Interval:
    """Cut every box in two along its widest side.

    Args:
        lower: (B, n).
        upper: (B, n).
        scale: (n,) weight of each side's width; None for equal ones.

    Returns:
        The (2 B, n) halves: all the lower ones, then the upper ones.
    """
    width = upper - lower if scale is None else (upper - lower) * scale
    rows, side = np.arange(len(lower)), np.argmax(width, axis=1)
    middle = 0.5 * (lower[rows, side] + upper[rows, side])
    left, right = upper.copy(), lower.copy()
    left[rows, side] = right[rows, side] = middle
    return Interval(np.concatenate((lower, right)), np.concatenate((left, upper)))


def _mean_value(value: Interval, slopes: Interval, offset: list[Interval]) -> Interval:
    for i, step in enumerate(offset):
        value = ia.add(value, ia.multiply(_row(slopes, i + 1), step))
    return value


def _row(bounds: Interval, k: int) -> Interval:
    return Interval(bounds.lower[k], bounds.upper[k])


def _columns(bounds: Interval) -> list[Interval]:
    return [Interval(a, b) for a, b in zip(bounds.lower.T, bounds.upper.T, strict=True)]


def _shared(values: Array) -> list[Interval]:
    return [Interval(x, x) for x in np.reshape(values, (-1, 1))]
