"""Where a number counts as zero: one place, so that every path draws the same line."""

MOBILITY_FLOOR = 1e-16
"""Below this h^T J M^-1 J^T h (1/kg) a contact cannot move along h: an infeasible direction."""

RANK_TOLERANCE = 1e-6
"""Singular values of a Jacobian below this share of its largest are zero: URDFs write pi/2 as
1.5708, and what is left of a direction then is 1e-7 of the others."""
