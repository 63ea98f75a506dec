"""The one door to ProxSuite: solve, certify, and say infeasible only when it is shown.

ProxQP's own verdicts are not trusted. Its default infeasibility thresholds (1e-4) call feasible
small programs infeasible, so they are tightened until they never fire on a feasible one; its
"solved" is checked with our residuals; and its iteration caps are set for programs of a dozen
variables, where the defaults can run for seconds.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from proxsuite import proxqp

from hitjoints.errors import InfeasibleError, SolverError
from hitjoints.programs.infeasibility import show_infeasible
from hitjoints.programs.problem import Program, Residuals, Solution, residuals

if TYPE_CHECKING:
    from numpy.typing import NDArray

CERTIFIED = 1e-8  # residuals, relative, at or below which an answer counts as solved
ATTEMPTS = (  # (eps_abs, rho, mu_eq, mu_in): the first settles nearly everything
    (1e-9, 1e-6, 1e-3, 1e-1),
    (1e-10, 1e-4, 1e-4, 1e-2),
    (1e-9, 1e-3, 1e-2, 1.0),
)
OUTER_CAP, INNER_CAP = 60, 60


def solve(program: Program) -> Solution:
    """Solve a small convex program.

    Returns:
        A solution whose residuals are at most `CERTIFIED`, its x within the bounds exactly.

    Raises:
        InfeasibleError: no x meets the constraints, with the proof in `data`.
        SolverError: neither a solution nor a proof of infeasibility was found.
    """
    scaled, scale = _scaled(program)
    best: Residuals | None = None
    for attempt in ATTEMPTS:
        found = _attempt(scaled, *attempt)
        if found is None:
            continue
        x = np.clip(found[0], program.lower, program.upper)
        y, z = found[1] * scale, found[2] * scale
        errors, w = residuals(program, x, y, z)
        if errors.worst <= CERTIFIED:
            return Solution(x, y, z, w, program.objective(x), errors)
        if best is None or errors.worst < best.worst:
            best = errors
    proof = show_infeasible(program)
    if proof is not None:
        raise InfeasibleError(proof.reason, {"multipliers": proof.multipliers.tolist()})
    raise SolverError(f"no certified solution: the best answer has residuals {best}")
