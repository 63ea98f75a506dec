"""Draw the arm in space: its shapes, the hitting joint, the object, and the inertia felt there."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.inertia import inverse_inertia
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InputError
from hitjoints.model.robot import Contact
from hitjoints.show.arm_faces import arm_faces, box_centre, box_faces
from hitjoints.show.inertia_surface import inertia_surface, round_number
from hitjoints.show.picture import Picture
from hitjoints.show.style import colour_of
from hitjoints.swings.clear_way import axes_along
from hitjoints.vectors import points, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

LINK, EDGE = "#DDE1E7", "#6B7280"
BOX, INERTIA = "#E69F00", "#0072B2"
ARROW = 0.25
"""m, length of the direction's arrow."""
SIDE = -30.0
"""deg, from where the picture is seen, about the vertical from across the direction."""
AXES = 0.12
"""m, length of the base frame's axes."""


@dataclass(frozen=True)
class BoxAt:
    """A box that is drawn.

    Attributes:
        corners: (8, 3) m, in the order of `itertools.product((-1, 1), repeat=3)`.
    """

    corners: Array

    @classmethod
    def touched(
        cls, robot: Robot, q: Array, contact: Contact, direction: Array, size: ArrayLike,
        yaw: float | None = None,
    ) -> BoxAt:  # fmt: skip
        """Return the object of a hit, its near face at the surface of the link that hits.

        Args:
            robot: the arm.
            q: (n,) rad, at the impact.
            contact: what touches it.
            direction: (3,), the hitting direction.
            size: (3,) m, edges.
            yaw: rad, the edges lie along the direction, across it and upwards, turned by that;
                None lays them along the axes of the base.

        Raises:
            InputError: no three lengths above zero.
        """
        edges, h = points(size, "object_size"), unit(direction)
        if edges.shape != (3,) or not (edges > 0).all():
            raise InputError("object_size", edges.tolist(), "three lengths above zero")
        axes = np.eye(3) if yaw is None else axes_along(h, yaw)
        centre = box_centre(robot, q, contact, h, edges, axes)
        return cls.placed(centre, edges, axes)

    @classmethod
    def placed(cls, centre: Array, size: Array, axes: Array) -> BoxAt:
        """Return a box by its centre (3,) m, edges (3,) m and axes (3, 3), in columns."""
        signs = np.array(list(product((-1, 1), repeat=3)))
        return cls(centre + (signs * np.asarray(size) / 2) @ axes.T)


def arm_picture(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int | None = None,
    direction: ArrayLike | None = None,
    *,
    box: BoxAt | None = None,
    ellipsoid: bool = True,
    azimuth: float | None = None,
) -> tuple[Picture, list[Any]]:
    """Return a picture of an arm, and its legend.

    The surface at the contact is the belted ellipsoid of the directional inertia: its distance
    from the contact along any direction u is 1 / (u^T J M^-1 J^T u), to a scale in the legend.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact that hits; none draws the arm alone.
        direction: (3,), the hitting direction, drawn as an arrow at the contact.
        box: the object.
        ellipsoid: draw the inertia at the contact.
        azimuth: deg, from where it is seen; by default across the direction.

    Raises:
        InputError: an argument cannot be used.
    """
    from matplotlib import rcParams
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    q = robot.one_configuration(q)
    h = None if direction is None else unit(direction)
    picture = Picture(_azimuth(h) if azimuth is None else azimuth)
    handles: list[Any] = []
    size = float(rcParams["lines.markersize"])
    picture.solid(arm_faces(robot, q), LINK)
    joints = np.array([position(robot, q, k) for k in range(1, robot.n + 1)])
    picture.line(joints, ls="", marker="o", color="white", mec=EDGE, mew=0.15 * size, ms=0.8 * size)
    if contact is not None:
        contact = robot.contact(contact)
        here, colour = position(robot, q, contact), colour_of(contact.joint)
        mark: dict[str, Any] = {
            "marker": "o",
            "color": colour,
            "mec": "white",
            "mew": 0.2 * size,
            "ms": 1.6 * size,
            "ls": "",
        }
        picture.line(np.stack([joints[contact.joint - 1], here]), color=colour, lw=2, zorder=64)
        picture.line(here[None], **mark, zorder=75)
        handles.append(Line2D([], [], **mark, label=f"joint {contact.joint}"))
        if h is not None:
            picture.arrow(here, here + ARROW * h, color="black", lw=1.5, mutation_scale=2.4 * size)
            arrow: dict[str, Any] = {
                "color": "black",
                "marker": ">",
                "lw": 1.5,
                "ms": size,
                "markevery": [1],
            }
            handles.append(Line2D([0, 1], [0, 0], **arrow, label="hitting direction"))
        surface = inertia_surface(inverse_inertia(robot, q, contact)) if ellipsoid else None
        if surface is not None:
            picture.solid(_quads(here + surface[0]), INERTIA, 0.16)
            handles.append(Patch(color=INERTIA, alpha=0.4, label=surface[1]))
    if box is not None:
        picture.solid(box_faces(box.corners), BOX, 0.35)
        picture.edges(box.corners, BOX)
        handles.append(Patch(facecolor=BOX, alpha=0.5, edgecolor=BOX, label="object"))
    return picture, handles


def add_ground(picture: Picture, seen: Array) -> str:
    """Add the floor's grid and the base frame's axes below what is seen, points (N, 3) m.

    Returns:
        how far apart the grid's lines are, in words.
    """
    low, high = np.minimum(seen.min(axis=0), -0.1), np.maximum(seen.max(axis=0), 0.1)
    apart = round_number(float((high - low).max()) / 5)
    ends = np.floor(low / apart) * apart, np.ceil(high / apart) * apart
    picture.floor(ends[0][:2], ends[1][:2], min(0.0, float(seen[:, 2].min())), apart)
    for axis, name in zip(np.eye(3), "xyz", strict=True):
        style = {"color": EDGE, "lw": 1.0, "mutation_scale": 8}
        picture.arrow(np.zeros(3), (AXES + 0.06) * axis, **style)
        picture.text((AXES + 0.1) * axis, name, color=EDGE)
    return f"grid {apart:g} m"


def chain(robot: Robot, q: Array) -> Array:
    """Return base, joints and flange at q (n,) rad as points (n + 2, 3) m."""
    joints = [position(robot, q, k) for k in range(1, robot.n + 1)]
    return np.array([np.zeros(3), *joints, position(robot, q, robot.flange)])


def _azimuth(h: Array | None) -> float:
    if h is None or float(np.hypot(*h[:2])) < 0.1:
        return -60.0
    return float(np.degrees(np.arctan2(h[1], h[0]))) - 90 + SIDE


def _quads(surface: Array) -> list[Array]:
    """Return the faces of a surface (rows, columns, 3) m."""
    rows, columns = surface.shape[:2]
    rows, columns = range(0, rows - 1, 2), range(0, columns - 1, 3)
    ends = [(r, c, min(r + 2, surface.shape[0] - 1), min(c + 3, surface.shape[1] - 1))
            for r in rows for c in columns]  # fmt: skip
    return [np.stack([surface[r, c], surface[r, e], surface[b, e], surface[b, c]])
            for r, c, b, e in ends]  # fmt: skip


def rgb(colour: str) -> tuple[float, float, float]:
    """Return a colour's red, green and blue, from 0 to 1."""
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
