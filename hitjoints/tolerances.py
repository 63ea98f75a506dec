"""Where a number counts as zero: one place, so that every path draws the same line."""

MOBILITY_FLOOR = 1e-16
"""Below this h^T J M^-1 J^T h (1/kg) a contact cannot move along h: an infeasible direction."""

RANK_TOLERANCE = 1e-9
"""Singular values of a Jacobian below this (m/rad) are zero: URDFs write pi/2 with 11 digits."""
