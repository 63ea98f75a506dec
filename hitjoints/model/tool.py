"""What is welded to an arm's flange, with the point that hits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from hitjoints.errors import InputError
from hitjoints.model.numbers import written
from hitjoints.model.tree import Body, Connection, roll_pitch_yaw
from hitjoints.vectors import real

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.tree import Tree

NAME, TIP = "tool", "tool_tip"
LARGEST = 1e6  # kg, m, kg m^2
ROUND_OFF = 1e-6  # relative slack for tensors written with a few digits


@dataclass(frozen=True, eq=False)
class Tool:
    """A rigid tool, told in the axes of the flange's frame.

    Args:
        mass: kg; 0 for a tip that weighs nothing.
        com: (3,) m, the centre of mass, from the flange.
        inertia: (3, 3) kg m^2 about the centre of mass, or (3,) of a diagonal one.
        tip: (3,) m, the point that hits, from the flange.
        radius: m, of the cylinder from flange to tip that stands for it in clearance and
            drawings; without one clearance is not known.

    Raises:
        InputError: the mass is negative, or no body has this tensor.
    """

    mass: float
    com: ArrayLike
    inertia: ArrayLike
    tip: ArrayLike
    radius: float | None = None

    def __post_init__(self) -> None:
        mass = real(self.mass, "tool mass", "a number in kg")
        if mass.shape != () or not 0 <= mass <= LARGEST:
            raise InputError(
                "tool mass", self.mass, f"a mass in kg, not below zero, at most {LARGEST:g}"
            )
        values = {"mass": float(mass)}
        if self.radius is not None:
            radius = real(self.radius, "tool radius", "a number in m")
            if radius.shape != () or not 0 < radius <= LARGEST:
                raise InputError("tool radius", self.radius, "a length in m above zero")
            values["radius"] = float(radius)
        for name in ("com", "tip"):
            object.__setattr__(self, name, _numbers(getattr(self, name), name, (3,)))
        for name, value in values.items():
            object.__setattr__(self, name, value)
        tensor = np.asarray(_numbers(self.inertia, "inertia", (3,), (3, 3)))
        tensor = np.diag(tensor) if tensor.ndim == 1 else tensor
        _check_tensor(tensor, self.mass)
        object.__setattr__(self, "inertia", tensor)

    @classmethod
    def read(cls, entries: Mapping[str, Any]) -> Tool:
        """Return the tool of a TOML's entries, which are named as the arguments.

        Raises:
            InputError: an entry is missing, unknown, or cannot be used.
        """
        known = [item.name for item in fields(cls)]
        for name in entries:
            if name not in known:
                raise InputError("tool", name, f"unknown entry; a tool has {', '.join(known)}")
        for name in known[:-1]:
            if name not in entries:
                raise InputError("tool", name, f"this entry is missing; it has {known[:-1]}")
        return cls(**entries)


def _numbers(value: ArrayLike, name: str, *shapes: tuple[int, ...]) -> NDArray[np.float64]:
    wanted = " or ".join(" x ".join(map(str, shape)) for shape in shapes) + " finite numbers"
    array = np.array(real(value, f"tool {name}", wanted))
    if array.shape not in shapes or not (np.abs(array) <= LARGEST).all():
        raise InputError(f"tool {name}", value, wanted)
    array.setflags(write=False)
    return array


def _check_tensor(tensor: NDArray[np.float64], mass: float) -> None:
    scale = np.abs(tensor).max()
    shown = tensor.tolist()
    if np.abs(tensor - tensor.T).max() > ROUND_OFF * scale:
        raise InputError("tool inertia", shown, "a symmetric tensor")
    small, middle, large = np.linalg.eigvalsh(tensor)
    moments = f"its principal moments are {small:.4g}, {middle:.4g}, {large:.4g} kg m^2"
    if small < -ROUND_OFF * scale:
        raise InputError("tool inertia", shown, f"none below zero; {moments}")
    if small + middle < large * (1 - ROUND_OFF):
        raise InputError("tool inertia", shown, f"no two less than the third; {moments}")
    if mass == 0 and scale > 0:
        raise InputError("tool inertia", shown, "zero, because the tool weighs nothing")


def weld(tree: Tree, flange: str, tool: Tool) -> tuple[Tree, str]:
    """Return a description with a tool on one of its links, and the name of the tip's link."""
    names = [_unused(tree, name) for name in (NAME, TIP)]
    body, tip = names
    tensor = np.asarray(tool.inertia)
    zero = np.zeros(3)
    bodies = {
        body: Body(
            body,
            tool.mass,
            np.asarray(tool.com),
            zero,
            tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]],
            has_inertial=tool.mass > 0,
            shapes=_shapes(tool),
        ),
        tip: Body(tip),
    }
    axis = np.array([1.0, 0.0, 0.0])
    joints = {
        f"{name}_mount": Connection(f"{name}_mount", "fixed", above, name, at, zero, axis)
        for name, above, at in ((body, flange, zero), (tip, body, np.asarray(tool.tip)))
    }
    return replace(tree, bodies=tree.bodies | bodies, joints=tree.joints | joints), tip


def _unused(tree: Tree, name: str) -> str:
    while name in tree.bodies or f"{name}_mount" in tree.joints:
        name += "_"
    return name


def _shapes(tool: Tool) -> tuple[Element, ...]:
    tip = np.asarray(tool.tip)
    length = float(np.linalg.norm(tip))
    if tool.radius is None or not length:
        return ()
    along = tip / length
    side = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    side /= np.linalg.norm(side)
    turn = np.column_stack([side, np.cross(along, side), along])
    shape = Element("collision")
    SubElement(shape, "origin", xyz=written(tip / 2), rpy=written(roll_pitch_yaw(turn)))
    solid = SubElement(shape, "geometry")
    SubElement(solid, "cylinder", radius=repr(tool.radius), length=repr(length))
    return (shape,)
