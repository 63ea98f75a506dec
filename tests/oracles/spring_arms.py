"""Random arms on springs, and a referee that integrates their equations as they stand."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from hitjoints.impact.spring_arm import SpringArm

Array = NDArray[np.float64]
JOINTS = 7
STEPS = 2000
LONGEST = 5


@dataclass
class Case:
    """An arm, an object and the spring between them."""

    M: Array
    g: Array
    B: Array
    K: Array
    D: Array
    Kp: Array
    Kd: Array
    m: float
    v: float
    k: float
    d: float
    time: float
    own: Array
    bend: float = 0.0

    @property
    def arm(self) -> SpringArm:
        response = np.asarray(np.linalg.inv(self.M), dtype=float)
        return SpringArm(
            response, self.g, self.B, self.K, self.D, (self.Kp, self.Kd), self.own, self.bend
        )

    @property
    def energy(self) -> float:
        """J, in the elongations' motion at the first touch: of all bodies and springs, from C."""
        lightness = block_diag(np.linalg.inv(self.M), np.diag(1 / self.B), 1 / self.m)
        zero, one = np.zeros((JOINTS, JOINTS)), np.eye(JOINTS)
        served = np.flatnonzero(self.Kp + self.Kd > 0)
        springs = np.vstack([np.hstack([-one, one]), np.hstack([zero, one])[served]])
        springs = block_diag(springs, -1.0)
        springs[-1, :JOINTS] = self.g
        inverse = np.linalg.inv(springs @ lightness @ springs.T)
        return float(self.v**2 / 2 * inverse[-1, -1])

    @property
    def fastest(self) -> float:
        """A bound of the frequencies, rad/s."""
        light = 1 / np.linalg.eigvalsh(self.M)[0] + 1 / self.B.min()
        pair = self.g @ np.linalg.solve(self.M, self.g) + 1 / self.m
        stiff = (self.K.max() + self.Kp.max()) * light + self.k * pair
        damped = (self.D.max() + self.Kd.max()) * light + self.d * pair
        return float(np.sqrt(stiff) + damped)


def random_case(
    random: np.random.Generator,
    *,
    stiffest: float = 5.5,
    lightest: float = -2,
    servo: bool = False,
    restitution: float | None = None,
) -> Case:
    """Return a case: inertias of 10^lightest to 5 kg m^2, joints of 1e2 to 10^stiffest N m/rad."""
    from hitjoints.impact.elastic import pair_spring

    turn, _ = np.linalg.qr(random.normal(size=(JOINTS, JOINTS)))
    M = turn * 10 ** random.uniform(lightest, 0.7, JOINTS) @ turn.T
    g = random.normal(size=JOINTS) * 0.5
    eps = random.uniform(0.05, 1.0) if restitution is None else restitution
    mass, time = 10 ** random.uniform(-1, 0.7), 10 ** random.uniform(-3, -1.7)
    zero = np.zeros(JOINTS)
    case = Case(
        M,
        g,
        B=10 ** random.uniform(lightest, 0.7, JOINTS),
        K=10 ** random.uniform(2, stiffest, JOINTS),
        D=random.choice([0.0, 1.0]) * random.uniform(0, 0.3, JOINTS),
        Kp=random.uniform(0, 2e3, JOINTS) if servo else zero,
        Kd=random.uniform(0, 30, JOINTS) if servo else zero,
        m=mass,
        v=random.uniform(0.2, 2.0),
        k=0.0,
        d=0.0,
        time=time,
        own=np.zeros(JOINTS),
    )
    case.k, case.d = pair_spring(case.arm.mobility, mass, eps, time)
    return case


def integrate(cases: list[Case], *, steps: int = STEPS) -> Array:
    """Return parting time, object speed and robot speed of every case (3, C).

    By Runge and Kutta's steps of order 4, all cases at once; nan where they touch for more than
    `LONGEST` contact times of the rigid pair.
    """
    n, size = JOINTS, 2 * JOINTS + 1

    def of(name: str) -> Array:
        values = np.array([getattr(case, name) for case in cases])
        return values if values.ndim > 1 else values[:, None]

    inverse, g, B, K, D = np.linalg.inv(of("M")), of("g"), of("B"), of("K"), of("D")
    Kp, Kd, m, v, k, d = of("Kp"), of("Kd"), of("m"), of("v"), of("k"), of("d")
    h, own, bend = 2 * of("time") / steps, of("own"), of("bend")

    def force(time: Array, s: Array) -> Array:
        depth = (
            v * time
            + bend * time**2 / 2
            + (g * s[:, :n]).sum(axis=1, keepdims=True)
            - s[:, 2 * n : 2 * n + 1]
        )
        moved = (g * s[:, size : size + n]).sum(axis=1, keepdims=True)
        return np.asarray(k * depth + d * (v + bend * time + moved - s[:, -1:]))

    def derivative(time: Array, s: Array) -> Array:
        q, t = s[:, :n], s[:, n : 2 * n]
        dq, dt = s[:, size : size + n], s[:, size + n : size + 2 * n]
        pull = K * (t - q) + D * (dt - dq)
        push = force(time, s)
        links = np.matmul(inverse, (pull - g * push)[:, :, None])[:, :, 0] + own
        rotors = (-pull - Kp * t - Kd * dt) / B
        return np.concatenate([s[:, size:], links, rotors, push / m], axis=1)

    def step(time: Array, s: Array, h: Array) -> Array:
        a = derivative(time, s)
        b = derivative(time + h / 2, s + h / 2 * a)
        c = derivative(time + h / 2, s + h / 2 * b)
        e = derivative(time + h, s + h * c)
        return s + h / 6 * (a + 2 * b + 2 * c + e)

    time, state = np.zeros_like(h), np.zeros((len(cases), 2 * size))
    touching = np.ones_like(h, dtype=bool)
    while (touching & (time <= LONGEST * of("time"))).any():
        after = step(time, state, h)
        touching &= force(time + h, after) > 0
        state, time = np.where(touching, after, state), np.where(touching, time + h, time)
    low, high = np.zeros_like(h), h
    for _ in range(50):
        middle = (low + high) / 2
        above = force(time + middle, step(time, state, middle)) > 0
        low, high = np.where(above, middle, low), np.where(above, high, middle)
    end = step(time, state, high)
    robot = (v + bend * (time + high))[:, 0] + (g * end[:, size : size + n]).sum(axis=1)
    found = np.array([(time + high)[:, 0], end[:, -1], robot])
    return np.where(touching[:, 0], np.nan, found)
