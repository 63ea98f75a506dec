"""Kinematics of a chain over abstract numbers, each vector in the frame of the link it belongs to.

Local frames keep the constants constant: a neighbour's axis, origin and inertia enter as numbers
known beforehand, and the mass matrix is seen not to depend on q_1 because nothing of it reaches the
base. Links are counted from 0 here.
"""

from __future__ import annotations

from hitjoints.kernels.formulas.chain import Chain, turn_of
from hitjoints.kernels.tape.trace import Scalar, Vector, cos, sin


def dot(a: Vector, b: Vector) -> Scalar:
    """Dot product a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Cross product a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], cross_z(a, b)


def cross_z(a: Vector, b: Vector) -> Scalar:
    """The z component of a x b."""
    return a[0] * b[1] - a[1] * b[0]


def plus(a: Vector, b: Vector) -> Vector:
    """Sum a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def minus(a: Vector, b: Vector) -> Vector:
    """Difference a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


class TracedArm:
    """A chain at a configuration.

    Args:
        chain: the constants.
        q: (n,) joint positions (rad, m), numbers of any kind.
    """

    def __init__(self, chain: Chain, q: tuple[Scalar, ...]) -> None:
        self.chain, self.links = chain, chain.links
        self.turns = [self._turn(i, angle) for i, angle in enumerate(q)]
        self.shifts = [self._shift(i, slide) for i, slide in enumerate(q)]

    def _turn(self, i: int, angle: Scalar) -> tuple[Scalar, Scalar]:
        link = self.links[i]
        c, s = turn_of(link.offset)
        if link.prismatic:
            return c, s
        if c * s != 0.0:
            return cos(angle + link.offset), sin(angle + link.offset)
        return c * cos(angle) - s * sin(angle), s * cos(angle) + c * sin(angle)

    def _shift(self, i: int, slide: Scalar) -> Vector:
        """Origin of link i in the frame before it."""
        link = self.links[i]
        if not link.prismatic:
            return link.translation
        c, s = link.tilt
        return plus(link.translation, (0.0, -s * slide, c * slide))

    def inward(self, i: int, v: Vector) -> Vector:
        """Components in link i's frame turned to those in the frame before."""
        (c, s), (c_tilt, s_tilt) = self.turns[i], self.links[i].tilt
        x, y, z = c * v[0] - s * v[1], s * v[0] + c * v[1], v[2]
        return x, c_tilt * y - s_tilt * z, s_tilt * y + c_tilt * z

    def outward(self, i: int, v: Vector) -> Vector:
        """Components in the frame before link i turned to those in link i's frame."""
        (c, s), (c_tilt, s_tilt) = self.turns[i], self.links[i].tilt
        x, y, z = v[0], c_tilt * v[1] + s_tilt * v[2], c_tilt * v[2] - s_tilt * v[1]
        return c * x + s * y, c * y - s * x, z

    def in_base(self, v: Vector) -> Vector:
        """World components turned into the resting frame of the first link."""
        rows = self.chain.base_rotation
        columns = list(zip(*rows, strict=True))
        return dot(columns[0], v), dot(columns[1], v), dot(columns[2], v)

    def in_world(self, v: Vector) -> Vector:
        """Components in the resting frame of the first link turned to the world."""
        rows = self.chain.base_rotation
        return dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)

    def in_links(self, v: Vector) -> list[Vector]:
        """A world vector in every link's frame."""
        views = [self.outward(0, self.in_base(v))]
        for i in range(1, len(self.links)):
            views.append(self.outward(i, views[-1]))
        return views

    def reaches(self, last: int, point: Vector) -> list[Vector]:
        """Vectors from the origins of links 0..last to a point fixed to link `last`, each in its
        frame.
        """
        vectors = [point]
        for i in range(last, 0, -1):
            vectors.append(plus(self.shifts[i], self.inward(i, vectors[-1])))
        return vectors[::-1]

    def position(self, last: int, point: Vector) -> Vector:
        """World position (m) of a point fixed to link `last` (-1: to the base)."""
        if last >= 0:
            point = plus(self.shifts[0], self.inward(0, self.reaches(last, point)[0]))
        return plus(self.chain.base_position, self.in_world(point))

    def row(self, reaches: list[Vector], views: list[Vector]) -> list[Scalar]:
        """J^T a (n) for a vector a seen from the links (m/rad): z . (r x a), or z . a for a
        slide.
        """
        moved = [
            a[2] if link.prismatic else cross_z(r, a)
            for link, r, a in zip(self.links, reaches, views, strict=False)
        ]
        return moved + [0.0] * (len(self.links) - len(moved))

    def size(self, reaches: list[Vector]) -> Scalar:
        """Square of the Frobenius norm of J."""
        total: Scalar = 0.0
        for link, r in zip(self.links, reaches, strict=False):
            total = total + (1.0 if link.prismatic else r[0] * r[0] + r[1] * r[1])
        return total

    def columns(self, reaches: list[Vector]) -> list[Vector]:
        """Columns of J in the first link's frame, for the joints 0..last."""
        x: Vector = (1.0, 0.0, 0.0)
        y: Vector = (0.0, 1.0, 0.0)
        z: Vector = (0.0, 0.0, 1.0)
        columns: list[Vector] = []
        for i, r in enumerate(reaches):
            if i:
                x, y, z = self._frame_of(i, x, y, z)
            columns.append(z if self.links[i].prismatic else _mix(r[0], y, -r[1], x))
        return columns

    def axes(self) -> list[Vector]:
        """Axes of the joints in the world, zero of those that slide."""
        x: Vector = (1.0, 0.0, 0.0)
        y: Vector = (0.0, 1.0, 0.0)
        z: Vector = (0.0, 0.0, 1.0)
        axes: list[Vector] = []
        for i, link in enumerate(self.links):
            if i:
                x, y, z = self._frame_of(i, x, y, z)
            still = (0.0, 0.0, 0.0)
            axes.append(still if link.prismatic else self.in_world(self.inward(0, z)))
        return axes

    def _frame_of(self, i: int, x: Vector, y: Vector, z: Vector) -> tuple[Vector, Vector, Vector]:
        """Axes of link i's frame from those of the one before, both in any frame."""
        (c, s), (c_tilt, s_tilt) = self.turns[i], self.links[i].tilt
        y, z = _mix(c_tilt, y, s_tilt, z), _mix(c_tilt, z, -s_tilt, y)
        return _mix(c, x, s, y), _mix(c, y, -s, x), z


def _mix(a: Scalar, u: Vector, b: Scalar, v: Vector) -> Vector:
    return a * u[0] + b * v[0], a * u[1] + b * v[1], a * u[2] + b * v[2]
