"""What is assumed of an object where a hit does not say it, so that it can be seen to slide."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from hitjoints.hit import Hit

USUAL = {"restitution": 0.5, "friction": 0.3}
SHARE = 0.1
"""Standard deviation of both as a share of each, assumed where the hit states none at all."""


class Assumption(NamedTuple):
    """A hit with nothing missing that a slide needs, and what was filled in, in words."""

    hit: Hit
    words: str


def assume(hit: Hit) -> Assumption:
    """Return a hit with restitution, friction and spreads, those it says itself as they are."""
    missing = {name: value for name, value in USUAL.items() if getattr(hit, name) is None}
    said = [f"{name} {value:g}" for name, value in missing.items()]
    if not hit.spread:
        said.append(f"standard deviations of {100 * SHARE:g} %")
    if not said:
        return Assumption(hit, "")
    filled = hit.changed(**missing)
    if not hit.spread:
        filled = filled.changed(spread={n: SHARE * getattr(filled, n) for n in USUAL})
    return Assumption(filled, "; ".join(said))
