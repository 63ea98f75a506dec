"""Symmetric positive definite systems of fixed size, as formulas."""

from __future__ import annotations

from hitjoints.kernels.tape.trace import Scalar, maximum


def solve_definite(
    matrix: list[list[Scalar]], right: list[Scalar], floor: list[Scalar] | None = None
) -> list[Scalar]:
    """Return A^-1 r by A = L D L^T.

    Args:
        matrix: A (n, n), its lower triangle.
        right: r (n).
        floor: least entries of D (n), where A may be singular.
    """
    n = len(right)
    lower: list[list[Scalar]] = [[0.0] * n for _ in range(n)]
    pivots: list[Scalar] = []
    inverse: list[Scalar] = []
    x = list(right)
    for j in range(n):
        scaled = [lower[j][k] * pivots[k] for k in range(j)]
        pivot = matrix[j][j]
        for k in range(j):
            pivot = pivot - scaled[k] * lower[j][k]
            x[j] = x[j] - lower[j][k] * x[k]
        if floor is not None:
            pivot = maximum(pivot, floor[j])
        pivots.append(pivot)
        inverse.append(1.0 / pivot)
        for i in range(j + 1, n):
            entry = matrix[i][j]
            for k in range(j):
                entry = entry - lower[i][k] * scaled[k]
            lower[i][j] = entry * inverse[j]
    x = [value * factor for value, factor in zip(x, inverse, strict=True)]
    for j in reversed(range(n)):
        for i in range(j + 1, n):
            x[j] = x[j] - lower[i][j] * x[i]
    return x
