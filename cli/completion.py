"""What a shell may complete an option's value to."""

from __future__ import annotations


def robots(incomplete: str) -> list[str]:
    """Return the robots that have names which begin so."""
    from hitjoints.loading.catalogue import robot_names

    return [name for name in robot_names() if name.startswith(incomplete)]


def objectives(incomplete: str) -> list[str]:
    """Return the objectives of a plan that begin so."""
    from hitjoints.planning.objectives.registry import OBJECTIVES

    return [name for name in OBJECTIVES if name.startswith(incomplete)]
