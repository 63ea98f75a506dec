"""Units, long names and provenance of the variables of a data set: one vocabulary (CF style)."""

from __future__ import annotations

from functools import cache
from importlib import metadata
from typing import TYPE_CHECKING, Any

from hitjoints.version import __version__

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.model.robot import Robot

UNITS = {
    "angle": ("rad", "position of the hitting joint"),
    "inertia": ("kg", "directional inertia along the hitting direction"),
    "inertia_min": ("kg", "least directional inertia over the samples"),
    "inertia_median": ("kg", "median directional inertia over the samples"),
    "inertia_max": ("kg", "greatest directional inertia over the samples"),
    "speed": ("m/s", "maximum hitting speed"),
    "speed_max": ("m/s", "greatest maximum hitting speed over the samples"),
    "straight_speed": ("m/s", "maximum hitting speed without sideways motion"),
    "flux": ("m/s", "maximum hitting flux"),
    "flux_median": ("m/s", "median of the maximum hitting flux over the samples"),
    "straight_flux": ("m/s", "maximum hitting flux without sideways motion"),
    "away": ("1", "the links beyond the joint can point away from the object (Eq. 14)"),
    "away_flux": ("m/s", "greatest hitting flux with the links beyond pointing away"),
    "rigid": ("kg", "directional inertia of the links alone"),
    "rotor": ("kg", "directional inertia with the rotors coupled rigidly"),
    "composite": ("kg", "directional inertia of the arm as one free rigid body"),
    "equivalent": ("kg", "inertia for which Eq. 3 gives the object's speed"),
    "shown": ("kg", "impulse over the loss of the contact's speed at the parting"),
    "object_speed": ("m/s", "speed of the object when arm and object part"),
    "robot_speed": ("m/s", "speed of the contact when arm and object part"),
    "contact_time": ("s", "how long arm and object touch"),
    "time": ("s", "contact time of the rigid pair"),
    "reachable": ("1", "share of the samples that place the joint at the position"),
    "position_error": ("m", "distance from the joint to the position"),
    "q": ("rad", "joint positions (m for a prismatic joint)"),
    "mass": ("kg", "mass of the object"),
    "best": ("1", "joint that hits best"),
    "crossing_mass": ("kg", "mass from which on another joint hits best"),
    "crossing_before": ("1", "joint that hits best below it"),
    "crossing_after": ("1", "joint that hits best above it"),
    "joint": ("1", "hitting joint, counted from 1"),
    "direction": ("1", "index of the hitting direction"),
    "direction_vector": ("1", "unit vector of the hitting direction, robot base frame"),
    "axis": ("1", "joint of the arm, counted from 1"),
    "x": ("m", "object position along x, robot base frame"),
    "y": ("m", "object position along y, robot base frame"),
    "z": ("m", "object position along z, robot base frame"),
    "miss": ("m", "distance of the contact from the object at the impact"),
    "direction_error": ("deg", "angle between the contact's velocity and the direction"),
    "hits": ("1", "share of the motions tried that hit the object along the direction"),
    "acceleration_ratio": ("1", "greatest acceleration in units of its limit"),
    "torque_ratio": ("1", "greatest torque in units of its limit"),
    "q0": ("rad", "joint positions at the start of the motion"),
    "q_hit": ("rad", "hitting configuration that the motion was made for"),
    "done": ("1", "the block has been computed"),
}
PACKAGES = ("pin", "numpy")


@cache  # finding them takes a millisecond
def versions() -> str:
    """Return the versions of hitjoints and of what its numbers hang on."""
    others = ", ".join(f"{name} {metadata.version(name)}" for name in PACKAGES)
    return f"hitjoints {__version__} ({others})"


def origin(robot: Robot) -> dict[str, Any]:
    """Return what a data set's numbers hang on: the robot and the versions."""
    return {
        "Conventions": "CF-1.11",
        "title": f"hitjoints: {robot.title}",
        "source": versions(),
        "robot": robot.name,
        "robot_digest": robot.digest,
    }


def described(dataset: Dataset, robot: Robot, **parameters: Any) -> Dataset:
    """Return the data set with units on its variables and its origin in its attributes."""
    for name, variable in dataset.variables.items():
        unit, long_name = UNITS[str(name)]
        variable.attrs = {"units": unit, "long_name": long_name}
    dataset.attrs = origin(robot) | parameters
    return dataset
