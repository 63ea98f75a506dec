"""How long a control step may be for a hit, and how short."""

from __future__ import annotations

from hitjoints.hitting.field import SIGMA

MOST_STEPS = 100_000
"""On the way to the object: ten seconds of computing."""


def wrong_step(speed: float, ahead: float, dt: float) -> str:
    """Return what is wrong with steps of dt (s), such as that they cross the width of the field.

    Args:
        speed: m/s, of the contact.
        ahead: m, from here to the object.
        dt: s.
    """
    if speed * dt > SIGMA:
        return f"at a hitting speed of {speed:.3g} m/s at most {SIGMA / speed:.2g} s"
    longest = MOST_STEPS * dt
    if ahead > speed * longest:
        return (
            f"{ahead:.3g} m at {speed:.3g} m/s take more than the "
            f"{longest:.3g} s of {MOST_STEPS} steps; take longer steps, or a greater flux"
        )
    return ""
