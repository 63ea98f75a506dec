"""Mass matrix, directional mobility and its gradient over abstract numbers.

Composite bodies (Featherstone, Rigid Body Dynamics Algorithms, ch. 6) in link frames, M = U D U^T
from the tip, so that the entries of U^-1 g beyond the contact's joint stay zero.
"""

from __future__ import annotations

from dataclasses import dataclass

from hitjoints.errors import ModelError
from hitjoints.kernels.formulas.links import TracedArm, cross, cross_z, dot, minus, plus
from hitjoints.kernels.formulas.regroup import Inertia
from hitjoints.kernels.tape.trace import Scalar, Vector

Tensor = tuple[Scalar, Scalar, Scalar, Scalar, Scalar, Scalar]


@dataclass(frozen=True)
class Composite:
    """Links i..n-1 as one body, about link i's origin: mass, first moment, inertia (xx yy zz xy xz
    yz).
    """

    mass: float
    moment: Vector
    tensor: Tensor

    def momentum(self, prismatic: bool) -> tuple[Vector, Vector]:
        """Angular and linear momentum per unit joint speed along or about z."""
        if prismatic:
            return (self.moment[1], -self.moment[0], 0.0), (0.0, 0.0, self.mass)
        return (self.tensor[4], self.tensor[5], self.tensor[2]), (
            -self.moment[1],
            self.moment[0],
            0.0,
        )

    def seen_from_parent(self, arm: TracedArm, i: int) -> Composite:
        """The same body in the frame of link i-1, about its origin."""
        (c, s), (c_tilt, s_tilt) = arm.turns[i], arm.links[i].tilt
        xx, yy, zz, xy, xz, yz = self.tensor
        k = s * (xx - yy) + 2.0 * (c * xy)
        xx, yy, xy = xx - s * k, yy + s * k, c * k - xy
        xz, yz = c * xz - s * yz, s * xz + c * yz
        cc, ss, cs = c_tilt * c_tilt, s_tilt * s_tilt, c_tilt * s_tilt
        xy, xz = c_tilt * xy - s_tilt * xz, s_tilt * xy + c_tilt * xz
        yy, zz, yz = (
            cc * yy - 2.0 * cs * yz + ss * zz,
            ss * yy + 2.0 * cs * yz + cc * zz,
            cs * (yy - zz) + (cc - ss) * yz,
        )
        x, y, z = arm.shifts[i]
        a = arm.inward(i, self.moment)
        b = plus(a, (self.mass * x, self.mass * y, self.mass * z))
        dx, dy, dz = x * (a[0] + b[0]), y * (a[1] + b[1]), z * (a[2] + b[2])
        tensor = (
            xx + dy + dz,
            yy + dx + dz,
            zz + dx + dy,
            xy - (x * b[1] + y * a[0]),
            xz - (x * b[2] + z * a[0]),
            yz - (y * b[2] + z * a[1]),
        )
        return Composite(self.mass, b, tensor)

    def with_body(self, body: Inertia) -> Composite:
        """Add the body of the link itself."""
        xx, yy, zz, xy, xz, yz = (a + b for a, b in zip(self.tensor, body.tensor, strict=True))
        moment = plus(self.moment, body.moment)
        return Composite(self.mass + body.mass, moment, (xx, yy, zz, xy, xz, yz))


def mass_matrix(arm: TracedArm) -> list[list[Scalar]]:
    """M(q) (n, n), the upper triangle filled (kg m^2)."""
    n = len(arm.links)
    M: list[list[Scalar]] = [[0.0] * n for _ in range(n)]
    composite = Composite(0.0, (0.0, 0.0, 0.0), (0.0,) * 6)
    for j in reversed(range(n)):
        composite = composite.with_body(arm.links[j].inertia)
        angular, linear = composite.momentum(arm.links[j].prismatic)
        M[j][j] = (linear if arm.links[j].prismatic else angular)[2] + arm.links[j].armature
        for i in range(j, 0, -1):
            linear = arm.inward(i, linear)
            angular = plus(arm.inward(i, angular), cross(arm.shifts[i], linear))
            M[i - 1][j] = (linear if arm.links[i - 1].prismatic else angular)[2]
        if j:
            composite = composite.seen_from_parent(arm, j)
    return M


def unit_matrix(n: int) -> list[list[Scalar]]:
    """Return the mass matrix of n joints that carry 1 kg m^2 each."""
    return [[1.0 if i == j else 0.0 for j in range(n)] for i in range(n)]


class Factor:
    """M = U D U^T with U unit upper triangular.

    Args:
        M: the mass matrix, upper triangle.

    Raises:
        ModelError: a joint carries no inertia, whatever the configuration.
    """

    def __init__(self, M: list[list[Scalar]]) -> None:
        n = len(M)
        work = [list(row) for row in M]
        self.U: list[list[Scalar]] = [[0.0] * n for _ in range(n)]
        self.inverse_D: list[Scalar] = [0.0] * n
        for j in reversed(range(n)):
            if work[j][j] == 0.0:
                raise ModelError("model", f"joint {j + 1} carries no inertia")
            self.inverse_D[j] = 1.0 / work[j][j]
            for i in range(j):
                self.U[i][j] = work[i][j] * self.inverse_D[j]
                for k in range(i + 1):
                    work[k][i] = work[k][i] - self.U[i][j] * work[k][j]

    def reduce(self, g: list[Scalar]) -> list[Scalar]:
        """U^-1 g."""
        y = list(g)
        for i in reversed(range(len(g))):
            for j in range(i + 1, len(g)):
                y[i] = y[i] - self.U[i][j] * y[j]
        return y

    def mobility(self, y: list[Scalar]) -> Scalar:
        """g^T M^-1 g (1/kg) from y = U^-1 g."""
        total: Scalar = 0.0
        for value, inverse in zip(y, self.inverse_D, strict=True):
            total = total + value * value * inverse
        return total

    def velocity(self, y: list[Scalar]) -> list[Scalar]:
        """U = M^-1 g from y = U^-1 g: the joint speeds after a unit impulse along h."""
        u = [value * inverse for value, inverse in zip(y, self.inverse_D, strict=True)]
        for i in range(len(u)):
            for j in range(i):
                u[i] = u[i] - self.U[j][i] * u[j]
        return u


def mobility_gradient(
    arm: TracedArm, reaches: list[Vector], directions: list[Vector], u: list[Scalar]
) -> list[Scalar]:
    """Derivative of h^T J M^-1 J^T h with respect to q (n), in O(n).

    It is 2 h^T d(J u)/dq - u^T dM/dq u at fixed u = M^-1 J^T h. Turning joint i carries along the
    momentum of the links beyond it, less the unit impulse at the contact, and the contact's own
    velocity.

    Args:
        arm: the arm at q.
        reaches: from each link that moves the contact to it.
        directions: h seen from every link.
        u: joint speeds.
    """
    omega, v = _velocities(arm, u)
    n, last = len(u), len(reaches) - 1
    gradient: list[Scalar] = [0.0] * n
    angular: Vector = (0.0, 0.0, 0.0)
    linear: Vector = (0.0, 0.0, 0.0)
    twist: Vector = (0.0, 0.0, 0.0)
    for i in reversed(range(n)):
        own_angular, own_linear = _momentum(arm.links[i].inertia, omega[i], v[i])
        angular, linear = plus(angular, own_angular), plus(linear, own_linear)
        if i == last:
            h = directions[i]
            angular, linear = minus(angular, cross(reaches[i], h)), minus(linear, h)
            twist = cross(plus(v[i], cross(omega[i], reaches[i])), h)
        if arm.links[i].prismatic:
            change = cross_z(linear, omega[i])
        else:
            change = cross_z(angular, omega[i]) + cross_z(linear, v[i]) - twist[2]
        gradient[i] = -2.0 * change
        if i:
            linear = arm.inward(i, linear)
            angular = plus(arm.inward(i, angular), cross(arm.shifts[i], linear))
            twist = arm.inward(i, twist)
    return gradient


def variation(
    arm: TracedArm, reaches: list[Vector], directions: list[Vector], u: list[Scalar]
) -> list[Scalar]:
    """2 g . u - u^T M u and its derivative with respect to q (n), at fixed u.

    For every u it is at most the mobility g^T M^-1 g, and at u = M^-1 g it is the mobility: a lower
    bound that needs no factor of M. Arguments as `mobility_gradient`.
    """
    speed: Scalar = 0.0
    for pull, rate in zip(arm.row(reaches, directions), u, strict=True):
        speed = speed + pull * rate
    value = 2.0 * speed - twice_kinetic_energy(arm, u)
    return [value, *mobility_gradient(arm, reaches, directions, u)]


def twice_kinetic_energy(arm: TracedArm, u: list[Scalar]) -> Scalar:
    """u^T M u (J) without forming M."""
    total: Scalar = 0.0
    for link, speed, omega, v in zip(arm.links, u, *_velocities(arm, u), strict=True):
        angular, linear = _momentum(link.inertia, omega, v)
        total = total + dot(angular, omega) + dot(linear, v) + speed * speed * link.armature
    return total


def _velocities(arm: TracedArm, u: list[Scalar]) -> tuple[list[Vector], list[Vector]]:
    """Angular and linear velocity of every link, in its frame."""
    omegas: list[Vector] = []
    velocities: list[Vector] = []
    omega: Vector = (0.0, 0.0, 0.0)
    v: Vector = (0.0, 0.0, 0.0)
    for i, (link, speed) in enumerate(zip(arm.links, u, strict=True)):
        v = arm.outward(i, plus(v, cross(omega, arm.shifts[i])))
        omega = arm.outward(i, omega)
        if link.prismatic:
            v = plus(v, (0.0, 0.0, speed))
        else:
            omega = plus(omega, (0.0, 0.0, speed))
        omegas.append(omega)
        velocities.append(v)
    return omegas, velocities


def _momentum(body: Inertia, omega: Vector, v: Vector) -> tuple[Vector, Vector]:
    """Angular and linear momentum of one body about its frame's origin."""
    xx, yy, zz, xy, xz, yz = body.tensor
    spin = (
        dot((xx, xy, xz), omega),
        dot((xy, yy, yz), omega),
        dot((xz, yz, zz), omega),
    )
    linear = plus(cross(omega, body.moment), (body.mass * v[0], body.mass * v[1], body.mass * v[2]))
    return plus(spin, cross(body.moment, v)), linear
