"""Compiled formulas of a robot, built on first use and kept: by the batch, or one at a time."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from functools import lru_cache
from threading import Lock
from typing import TYPE_CHECKING

from hitjoints.errors import ModelError

if TYPE_CHECKING:
    from hitjoints.kernels import Chain, Kernel
    from hitjoints.kernels.single import SingleKernel
    from hitjoints.model.robot import Contact, Robot

_building = [Lock()]


def _after_fork() -> None:
    """Free the lock in a child: the thread that may have held it is not there."""
    _building[0] = Lock()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def kernel_for(robot: Robot, contacts: tuple[Contact, ...], outputs: tuple[str, ...]) -> Kernel:
    """Return the batch kernel of a robot for some contacts and outputs."""
    with _building[0]:  # two threads must not build the same one twice
        return _kernel(robot, contacts, outputs)


def single_for(robot: Robot, contact: Contact, outputs: tuple[str, ...]) -> SingleKernel:
    """Return the same for one contact and one configuration at a time. Needs llvmlite."""
    with _building[0]:
        return _single(robot, contact, outputs)


@lru_cache(maxsize=16)
def chain_of(robot: Robot) -> Chain:
    """Return the constants of a robot's formulas."""
    from hitjoints.kernels import Chain

    return Chain.from_model(robot.model)


@lru_cache(maxsize=64)
def _kernel(robot: Robot, contacts: tuple[Contact, ...], outputs: tuple[str, ...]) -> Kernel:
    from hitjoints.kernels import build_kernel

    points = tuple((contact.joint, contact.offset) for contact in contacts)
    with refused_by_name(robot):
        return build_kernel(robot.model, contacts=points, outputs=outputs)


@lru_cache(maxsize=64)
def _single(robot: Robot, contact: Contact, outputs: tuple[str, ...]) -> SingleKernel:
    from hitjoints.kernels.single import build_single

    with refused_by_name(robot):
        return build_single(robot.model, (contact.joint, contact.offset), outputs)


@contextmanager
def refused_by_name(robot: Robot) -> Iterator[None]:
    """Say of which robot a model is refused, and that it has no mass if that is why."""
    try:
        yield
    except ModelError as error:
        robot.require_mass()
        raise ModelError(robot.name, error.reason) from None
