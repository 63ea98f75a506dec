"""A box slides and turns on a level table until it rests: Coulomb friction over what carries it.

The pressure under the box is linear, and its centre lies ahead of the box's by what friction, which
acts at the table, tips about the centre of mass: half the height times friction over weight. That
is what makes the path of a turning box curl.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.errors import InputError, UnknownNameError
from hitjoints.vectors import points

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import ArrayLike

    from hitjoints.types import Array

Support = Literal["face", "corners"]
GAUSS = 8
"""Gauss points along an edge of the face."""
NODES = 6
"""Points along an edge of the face, ends included."""
STEP = 0.15
"""Share of the present time to rest that one step takes."""
REST = 1e-3
"""Share of the first speed at which the box counts as resting: what is left of the way is its
square."""


@dataclass(frozen=True, eq=False)
class Rest:
    """Where boxes come to rest.

    Attributes:
        displacement: (N, 2) m, of the centre, from where it began to slide.
        yaw: (N,) rad, turned on the way.
        time: (N,) s.
    """

    displacement: Array
    yaw: Array
    time: Array


def slide_to_rest(
    velocity: ArrayLike,
    spin: ArrayLike,
    size: ArrayLike,
    friction: ArrayLike,
    *,
    yaw: ArrayLike = 0.0,
    support: Support = "face",
) -> Rest:
    """Slide boxes on a level table until they rest.

    Args:
        velocity: (N, 2) m/s of the centre, horizontal.
        spin: (N,) rad/s about the vertical, or one for all.
        size: (3,) or (N, 3) m, edges of the box.
        friction: (N,) mu > 0, or one for all.
        yaw: (N,) rad, direction of the first edge against the first axis, or one for all.
        support: what carries the box, its whole "face" or its four "corners".

    Raises:
        InputError: a size or a friction is not above 0, or a box would tip over its edge.
    """
    *_, (time, state) = slide_steps(velocity, spin, size, friction, yaw=yaw, support=support)
    return Rest(state[:, 3:5], state[:, 5] - np.asarray(yaw, dtype=float), time)


def slide_steps(
    velocity: ArrayLike,
    spin: ArrayLike,
    size: ArrayLike,
    friction: ArrayLike,
    *,
    yaw: ArrayLike = 0.0,
    support: Support = "face",
) -> Iterator[tuple[Array, Array]]:
    """Yield the times (N,) s and the states (N, 6) on the way to rest, the first at time 0.

    A state is vx, vy (m/s), spin (rad/s), x, y (m) and yaw (rad); arguments and errors are those of
    `slide_to_rest`.
    """
    check_support(support)
    v = np.atleast_2d(np.asarray(velocity, dtype=float))
    count = len(v)
    w, mu, turned = (
        np.broadcast_to(np.asarray(a, dtype=float), count) for a in (spin, friction, yaw)
    )
    edges = np.broadcast_to(points(size, "size"), (count, 3))
    if not (edges > 0).all():
        raise InputError("size", edges[(edges <= 0).any(axis=1)][0].tolist(), "edges above 0 m")
    if bad := [float(value) for value in mu if not 0 < value < np.inf]:
        raise InputError("friction", bad[0], "finite and above 0")
    boxes = _Boxes(edges, mu, support)
    state = np.column_stack((v, w, np.zeros((count, 2)), turned))
    first = boxes.speed(state)
    time = np.zeros(count)
    yield time.copy(), state.copy()
    moving = first > 0
    while moving.any():
        some = _Boxes(edges[moving], mu[moving], support)
        dt = STEP * some.speed(state[moving]) / (mu[moving] * GRAVITY)
        state[moving] = _runge_kutta(some, state[moving], dt)
        time[moving] += dt
        yield time.copy(), state.copy()
        moving = boxes.speed(state) > REST * first


def check_support(support: str) -> None:
    """Refuse a name that is none of `Support`.

    Raises:
        UnknownNameError: it is not.
    """
    if support not in ("face", "corners"):
        raise UnknownNameError("support", support, ("face", "corners"))


def support_nodes(support: Support) -> tuple[Array, Array]:
    """Return points from -1 to 1, along an edge, that carry a box, and their shares of the load.

    Those of a face are Gauss-Lobatto points: sums over them are integrals, and ends are ends.
    """
    if support == "corners":
        return np.array([-1.0, 1.0]), np.array([0.5, 0.5])
    legendre = np.polynomial.legendre.Legendre.basis(NODES - 1)
    inner = np.sort(legendre.deriv().roots().real)
    nodes = np.concatenate(([-1.0], inner, [1.0]))
    return nodes, np.asarray(1 / (NODES * (NODES - 1) * legendre(nodes) ** 2))


class _Boxes:
    """Boxes of edges (N, 3) m and friction (N,) on their support.

    Places on the face are shares X, Y of the half edges, from -1 to 1, the same for all boxes; sums
    over the face are products with the columns of `moments`: weights times 1, X, Y, XX, XY, YY.
    """

    def __init__(self, edges: Array, mu: Array, support: Support) -> None:
        if support == "corners":
            nodes, weights = support_nodes(support)
        else:
            nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
            weights = weights / 2
        grid_x, grid_y = np.meshgrid(nodes, nodes, indexing="ij")
        self._x, self._y = grid_x.ravel(), grid_y.ravel()
        weight = np.outer(weights, weights).ravel()
        x, y = self._x, self._y
        self.moments = np.column_stack([weight * m for m in (x**0, x, y, x * x, x * y, y * y)])
        self._mu, self._half = mu, edges / 2
        self._tilt = (weight * self._x**2).sum()  # a linear pressure's, over the face
        self._radius2 = (edges[:, 0] ** 2 + edges[:, 1] ** 2) / 12

    def speed(self, state: Array) -> Array:
        """Return the speed (N,) m/s whose energy is that of sliding and turning."""
        v2 = state[:, 0] ** 2 + state[:, 1] ** 2
        return np.asarray(np.sqrt(v2 + self._radius2 * state[:, 2] ** 2))

    def rate(self, state: Array) -> Array:
        """Return d state / dt (N, 6) of vx, vy, w, x, y, yaw."""
        vx, vy, w, _, _, yaw = state.T
        cos, sin = np.cos(yaw), np.sin(yaw)
        # In the box's own axes, where its face does not turn.
        slip_x = np.outer(-w * self._half[:, 1], self._y)
        slip_x += (cos * vx + sin * vy)[:, None]
        slip_y = np.outer(w * self._half[:, 0], self._x)
        slip_y += (cos * vy - sin * vx)[:, None]
        length = np.hypot(slip_x, slip_y)
        length[length == 0] = np.inf
        force, moment = self._friction(
            (slip_x / length) @ self.moments, (slip_y / length) @ self.moments
        )
        ax, ay = force.T
        mug = self._mu * GRAVITY
        return np.column_stack(
            (
                mug * (cos * ax - sin * ay),
                mug * (sin * ax + cos * ay),
                mug * moment / self._radius2,
                vx,
                vy,
                w,
            )
        )

    def _friction(self, along: Array, across: Array) -> tuple[Array, Array]:
        """Return force (N, 2) and moment (N,) in units of mu m g.

        Args:
            along: (N, 6) moments over the face of the slip's direction, its first component.
            across: (N, 6) the same of its second.

        The pressure 1 + (X s_x / a + Y s_y / b) / tilt has its centre at s = -mu c force, and the
        force comes from the pressure: linear in both, solved.
        """
        a, b, up = self._half.T
        ahead = self._mu * up / self._tilt
        slope = np.stack((ahead / a, ahead / b), axis=1)
        by_pressure = np.stack((along[:, 1:3], across[:, 1:3]), axis=1) * slope[:, None, :]
        even = np.stack((along[:, 0], across[:, 0]), axis=1)
        force = np.linalg.solve(np.eye(2) - by_pressure, -even[..., None])[..., 0]
        tilted = -slope * force
        moment = a * (across[:, 1] + tilted[:, 0] * across[:, 3] + tilted[:, 1] * across[:, 4])
        moment -= b * (along[:, 2] + tilted[:, 0] * along[:, 4] + tilted[:, 1] * along[:, 5])
        return force, -moment


def _runge_kutta(boxes: _Boxes, state: Array, dt: Array) -> Array:
    h = dt[:, None]
    k1 = boxes.rate(state)
    k2 = boxes.rate(state + h / 2 * k1)
    k3 = boxes.rate(state + h / 2 * k2)
    k4 = boxes.rate(state + h * k3)
    return np.asarray(state + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
