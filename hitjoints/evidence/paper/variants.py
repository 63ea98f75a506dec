"""The arms the paper's numbers are compared on: three readings of the inertia of one iiwa 14."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from dataclasses import replace

from hitjoints.loading.load import build_robot, describe, load_robot
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
    root = ET.fromstring(clean.arm.xml)
    flange = root.find("link[@name='flange']")
    assert flange is not None
    inertial = ET.SubElement(flange, "inertial")
    ET.SubElement(inertial, "mass", value=f"{PHANTOM_MASS}")
    moments = dict.fromkeys(("ixx", "iyy", "izz"), f"{PHANTOM_INERTIA}")
    ET.SubElement(inertial, "inertia", moments | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))
    arm = replace(clean.arm, xml=ET.tostring(root, encoding="unicode"))
    facts = {**clean.facts, "title": f"{clean.facts['title']}, phantom inertia at its flange"}
    return build_robot(replace(clean, name="iiwa14_phantom", arm=arm, facts=facts))
