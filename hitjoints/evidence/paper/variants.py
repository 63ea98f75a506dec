"""The arms the paper's numbers are compared on: three readings of the inertia of one iiwa 14."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from hitjoints.loading.load import build_robot, load_robot, read_arm
from hitjoints.loading.source import describe
from hitjoints.model.robot import Robot

VARIANTS = ("iiwa14_bullet", "iiwa14", "iiwa14_phantom")
PHANTOM_MASS = 1e-6
"""kg, and"""
PHANTOM_INERTIA = 1.0
"""kg m^2 about each axis: what epfl-lasa/iiwa_ros gives the iiwa 14's flange."""


def variant(name: str) -> Robot:
    """Return one of `VARIANTS`."""
    return phantom_robot() if name == "iiwa14_phantom" else load_robot(name)


def phantom_robot() -> Robot:
    """Return the iiwa 14 with the phantom inertia at its flange.

    The parser lumps it into link 7. `load_robot` would warn of it; here it is made on purpose.
    """
    clean = describe("iiwa14")
    tree = read_arm(clean).tree
    moments = np.array([PHANTOM_INERTIA] * 3 + [0.0] * 3)
    flange = replace(tree.bodies["flange"], mass=PHANTOM_MASS, moments=moments, has_inertial=True)
    tree = replace(tree, bodies={**tree.bodies, "flange": flange})
    facts = {**clean.facts, "title": f"{clean.facts['title']}, phantom inertia at its flange"}
    spoilt = replace(clean, name="iiwa14_phantom", tree=tree, facts=facts)
    return build_robot(spoilt, read_arm(spoilt))
