"""What a solver of quadratic programs has to offer: one file, such as `programs.proxqp`."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from hitjoints.programs.problem import Matrix, Program, Vector


class Warm(Protocol):
    """The same QP again and again, each from the previous answer."""

    def __call__(
        self, H: Matrix, c: Vector, A: Matrix, b: Vector, lower: Vector, upper: Vector
    ) -> tuple[Vector, Vector]:
        """Return x (n,) and the multipliers y (m,) of the equalities; they are checked."""
        ...


class BackEnd(Protocol):
    """A module with these two names. Its answers may be wrong: they are polished and certified."""

    @property
    def attempts(self) -> Callable[[Program], Iterator[tuple[Vector, Vector, Vector]]]:
        """Yield answers x, y, z of a program scaled to size one, the next if one will not do."""
        ...

    @property
    def WarmStart(self) -> Callable[[int, int], Warm]:
        """Make one for n variables and m equalities."""
        ...
