"""Draw the arm in space: links, the hitting joint, the object, and the inertia felt there."""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.dynamics.inertia import inverse_inertia
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InputError
from hitjoints.model.robot import Contact
from hitjoints.show.figures import colour_of
from hitjoints.tolerances import MOBILITY_FLOOR
from hitjoints.vectors import points, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

LINK, EDGE = "#C9CED6", "#6B7280"
BOX, INERTIA = "#E69F00", "#0072B2"
ARROW = 0.25  # m, length of the direction's arrow
TYPICAL = 0.10  # m, about the radius at which the median inertia is drawn
LONGEST = 0.20  # m, where the inertia is cut off: at a singularity it is infinite


def draw_arm(
    axis: Any,
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int | None = None,
    direction: ArrayLike | None = None,
    *,
    object_size: ArrayLike | None = None,
    ellipsoid: bool = True,
    view: bool = True,
) -> None:
    """Draw an arm on a matplotlib 3-D axis.

    The surface at the contact is the belted ellipsoid of the directional inertia: its distance
    from the contact along any direction u is 1 / (u^T J M^-1 J^T u), to a scale in the legend.

    Args:
        axis: made with projection="3d".
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact that hits; none draws the arm alone.
        direction: (3,), the hitting direction, drawn as an arrow at the contact.
        object_size: (3,) m, edges of a box whose near face is at the contact; needs a direction.
        ellipsoid: draw the inertia at the contact.
        view: set limits, an equal aspect and the point of view. False leaves the axis as it is,
            to draw several configurations on one.

    Raises:
        InputError: an argument cannot be used.
    """
    q = robot.one_configuration(q)
    joints = np.array([position(robot, q, k) for k in range(1, robot.n + 1)])
    chain = np.vstack([np.zeros(3), joints, position(robot, q, robot.flange)])
    drawn = [chain]
    _draw_links(axis, chain)
    axis.plot(*joints.T, "o", color="white", mec=EDGE, mew=1.2, ms=5.5, zorder=20)
    if contact is not None:
        contact = robot.contact(contact)
        here = position(robot, q, contact)
        colour = colour_of(contact.joint)
        joint = joints[contact.joint - 1]
        axis.plot(*np.stack([joint, here]).T, color=colour, lw=2.5, zorder=24)
        name = f"joint {contact.joint}"
        axis.plot(
            *here[:, None], "o", color=colour, mec="white", mew=1.2, ms=10, zorder=25, label=name
        )
        if direction is not None:
            h = unit(direction)
            drawn.append(np.stack([here, here + ARROW * h]))
            axis.quiver(
                *here, *(ARROW * h), color="black", lw=2, arrow_length_ratio=0.22, zorder=30
            )
            axis.plot([], [], "-", color="black", lw=2, label="hitting direction")
        if ellipsoid:
            drawn.append(_draw_inertia(axis, here, inverse_inertia(robot, q, contact)))
    if object_size is not None:
        if contact is None or direction is None:
            raise InputError("object_size", object_size, "a contact and a direction place the box")
        drawn.append(_draw_box(axis, here, h, points(object_size, "object_size")))
    if view:
        set_view(axis, np.vstack(drawn))


def belted_ellipsoid(inverse: ArrayLike, rows: int = 33, columns: int = 64) -> tuple[Array, Array]:
    """Return directions and the directional inertia along each.

    Args:
        inverse: (3, 3) 1/kg, J M^-1 J^T.
        rows: of the grid over the sphere, pole to pole and around; the poles are where the inertia
            is least, and round them the surface is smooth.
        columns: of the grid over the sphere, pole to pole and around; the poles are where the
            inertia is least, and round them the surface is smooth.

    Returns:
        (rows, columns, 3) unit vectors; (rows, columns) kg, inf where the contact cannot move.
    """
    Li = np.asarray(inverse, dtype=float)
    axes = np.linalg.eigh(Li)[1]
    polar, around = np.linspace(0, np.pi, rows), np.linspace(0, 2 * np.pi, columns)
    local = np.stack(
        [
            np.outer(np.sin(polar), np.cos(around)),
            np.outer(np.sin(polar), np.sin(around)),
            np.outer(np.cos(polar), np.ones(columns)),
        ],
        axis=-1,
    )
    u = local @ axes.T
    mobility = np.einsum("rci,ij,rcj->rc", u, Li, u)
    movable = mobility > MOBILITY_FLOOR
    return u, np.where(movable, 1.0 / np.where(movable, mobility, 1.0), np.inf)


def add_solid(axis: Any, corners: Array) -> None:
    """Draw the object, a box.

    Args:
        axis: made with projection="3d".
        corners: (8, 3) m, in the order of `itertools.product((-1, 1), repeat=3)`.
    """
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection  # type: ignore[import-untyped]

    faces = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]
    solid = Poly3DCollection(
        [corners[list(face)] for face in faces],
        facecolor=(*rgb(BOX), 0.25), edgecolor=BOX, linewidths=1.0, zorder=8, label="object",
    )  # fmt: skip
    axis.add_collection3d(solid)


def set_view(axis: Any, drawn: Array) -> None:
    """Set limits, an equal aspect and the point of view for what is drawn: points (N, 3) m."""
    from matplotlib.ticker import MultipleLocator

    low, high = drawn.min(axis=0), drawn.max(axis=0)
    low[2] = min(low[2], 0.0)
    low, high = low - 0.05, high + 0.05
    low[2] += 0.05
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axis.set_box_aspect(high - low, zoom=0.88)
    axis.set(xlabel="x (m)", ylabel="y (m)", zlabel="z (m)")
    axis.view_init(elev=18, azim=-60)
    apart = _round_number(float((high - low).max()) / 4)
    for side in (axis.xaxis, axis.yaxis, axis.zaxis):
        side.set_major_locator(MultipleLocator(apart))
        side.set_pane_color((1, 1, 1, 0))
        side._axinfo["grid"].update(color="#E5E7EB", linewidth=0.6)
    axis.computed_zorder = False


def _draw_links(axis: Any, chain: Array) -> None:
    widths = np.linspace(15, 7, len(chain) - 1)
    for outline in (True, False):
        for i, width in enumerate(widths):
            axis.plot(
                *chain[i : i + 2].T,
                color=EDGE if outline else LINK,
                lw=width + 2 if outline else width,
                solid_capstyle="round",
                zorder=5 if outline else 6,
            )
    axis.plot(*chain[:1].T, "s", color=EDGE, ms=15, zorder=4)


def inertia_surface(inverse: ArrayLike) -> tuple[Array, str] | None:
    """Return the belted ellipsoid of the directional inertia as a surface round the contact.

    Args:
        inverse: (3, 3) 1/kg, J M^-1 J^T.

    Returns:
        (rows, columns, 3) m from the contact, cut at `LONGEST`; what it is, with its scale. None
        if the contact cannot move at all.
    """
    u, inertia = belted_ellipsoid(inverse)
    finite = inertia[np.isfinite(inertia)]
    if not finite.size:
        return None
    per_length = _round_number(0.1 * float(np.median(finite)) / TYPICAL)  # kg per 10 cm
    radius = np.minimum(0.1 * inertia / per_length, LONGEST)
    note = f", cut at {LONGEST * 100:g} cm" if (radius >= LONGEST).any() else ""
    return radius[..., None] * u, f"directional inertia, 10 cm = {per_length:g} kg{note}"


def _draw_inertia(axis: Any, here: Array, inverse: Array) -> Array:
    drawn = inertia_surface(inverse)
    if drawn is None:
        return here[None]
    surface, label = here + drawn[0], drawn[1]
    style = {"color": INERTIA, "alpha": 0.22, "linewidth": 0, "antialiased": True, "shade": True}
    axis.plot_surface(*np.moveaxis(surface, -1, 0), rstride=1, cstride=1, zorder=10, **style)
    axis.plot_wireframe(
        *np.moveaxis(surface, -1, 0), rstride=8, cstride=8, color=INERTIA, lw=0.5, alpha=0.5
    )
    axis.plot([], [], "-", color=INERTIA, alpha=0.5, lw=8, label=label)
    return np.asarray(surface.reshape(-1, 3))


def _round_number(value: float) -> float:
    """Return the nearest of 1, 2, 5 times a power of ten."""
    choices = np.array([1.0, 2.0, 5.0, 10.0]) * 10.0 ** np.floor(np.log10(value))
    return float(choices[np.argmin(np.abs(np.log(choices / value)))])


def _draw_box(axis: Any, here: Array, h: Array, size: Array) -> Array:
    if size.shape != (3,) or not (size > 0).all():
        raise InputError("object_size", size.tolist(), "three lengths above zero")
    half = np.min(size / 2 / np.maximum(np.abs(h), np.finfo(float).tiny))
    corners = here + half * h + size / 2 * np.array(list(product((-1, 1), repeat=3)))
    add_solid(axis, corners)
    return np.asarray(corners)


def rgb(colour: str) -> tuple[float, float, float]:
    """Return a colour's red, green and blue, from 0 to 1."""
    from matplotlib.colors import to_rgb

    return to_rgb(colour)
