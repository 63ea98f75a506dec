"""Random programs for the tests, each from its own generator: same seed, same program."""

from __future__ import annotations

import numpy as np

from hitjoints.programs.hitting_speed import step_bounds
from hitjoints.programs.problem import Program


def jacobian(rng):
    """3 x 6 .. 3 x 8, a third of them near-singular, of rank 2 or of rank 1."""
    n = int(rng.integers(6, 9))
    J = rng.normal(size=(3, n)) * rng.uniform(0.05, 1)
    kind = int(rng.integers(9))
    if kind > 2:
        return J
    U, s, Vt = np.linalg.svd(J, full_matrices=False)
    if kind == 0:
        s[2] *= 10 ** rng.uniform(-5, -2)
    else:
        s[kind:] = 0  # the products below leave rows of 1e-17
    return U * s @ Vt


def velocity_box(rng, n):
    """Limits of a real arm (0.5 .. 4 rad/s), symmetric or not, some locked, some by position."""
    upper = rng.uniform(0.5, 4, n)
    lower = -upper if rng.random() < 0.5 else -rng.uniform(0.1, 4, n)
    locked = rng.random(n) < 0.1
    lower, upper = np.where(locked, 0.0, lower), np.where(locked, 0.0, upper)
    if rng.random() < 0.5:
        return lower, upper
    low, high = -rng.uniform(1, 3, n), rng.uniform(1, 3, n)
    q = np.where(rng.random(n) < 0.2, high, rng.uniform(low, high))
    high = np.where(rng.random(n) < 0.1, np.inf, high)
    return step_bounds(q, low, high, lower, upper, 10 ** rng.uniform(-3, -0.5))


def direction(rng):
    if rng.random() < 0.2:
        return np.eye(3)[rng.integers(3)] * rng.choice([-1.0, 1.0])
    h = rng.normal(size=3)
    return h / np.linalg.norm(h)


def feasible(rng, rows=4, quadratic=False):
    """A program around a point of its box; some inequalities touch it, some variables are fixed."""
    n = int(rng.integers(2, 11))
    lower, upper = -rng.uniform(0.1, 3, n), rng.uniform(0.1, 3, n)
    fixed = rng.random(n) < 0.1
    lower = np.where(fixed, upper, lower)
    x = rng.uniform(lower, upper)
    A = rng.normal(size=(int(rng.integers(0, min(rows, n))), n))
    C = rng.normal(size=(int(rng.integers(0, 5)), n))
    d = C @ x + rng.uniform(0, 1, len(C)) * (rng.random(len(C)) < 0.5)
    H = None
    if quadratic:
        F = rng.normal(size=(int(rng.integers(1, n + 1)), n))
        H = F.T @ F
    return Program(rng.normal(size=n), lower, upper, H, A, A @ x, C, d)


def contradiction(rng):
    """A feasible program with a row that others contradict by 1e-4 .. 1 of its size."""
    p = feasible(rng, quadratic=rng.random() < 0.5)
    by = 10 ** rng.uniform(-4, 0)
    row = rng.normal(size=p.n)
    row /= np.linalg.norm(row)
    at = float(row @ rng.uniform(p.lower, p.upper))
    size = 10 ** rng.uniform(-4, 4)  # of the contradicting row, which is badly scaled as well
    if rng.random() < 0.5:
        A, b = np.vstack([p.A, row, size * row]), np.concatenate([p.b, [at, size * (at + by)]])
        return Program(p.c, p.lower, p.upper, p.H, A, b, p.C, p.d)
    second = rng.normal(size=p.n)
    C = np.vstack([p.C, row + second, -size * row, -second])
    d = np.concatenate([p.d, [at, -size * (at + by), 0.0]])
    return Program(p.c, p.lower, p.upper, p.H, p.A, p.b, C, d)


def empty_box(rng):
    p = feasible(rng)
    lower = p.lower.copy()
    i = int(rng.integers(p.n))
    lower[i] = p.upper[i] + 10 ** rng.uniform(-12, 0)
    return Program(p.c, lower, p.upper, p.H, p.A, p.b, p.C, p.d)
