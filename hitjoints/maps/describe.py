"""Units, long names and provenance of the variables of a data set: one vocabulary (CF style)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from hitjoints.version import __version__

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.robot import Robot

UNITS = {
    "angle": ("rad", "position of the hitting joint"),
    "inertia": ("kg", "directional inertia along the hitting direction"),
    "speed": ("m/s", "maximum hitting speed"),
    "straight_speed": ("m/s", "maximum hitting speed without sideways motion"),
    "flux": ("m/s", "maximum hitting flux"),
    "straight_flux": ("m/s", "maximum hitting flux without sideways motion"),
    "reachable": ("1", "the joint can be placed at the position"),
    "position_error": ("m", "distance from the joint to the position"),
    "q": ("rad", "joint positions (m for a prismatic joint)"),
    "joint": ("1", "hitting joint, counted from 1"),
    "axis": ("1", "joint of the arm, counted from 1"),
}


def described(dataset: Dataset, robot: Robot, **parameters: Any) -> Dataset:
    """Return the data set with units on its variables and its origin in its attributes."""
    for name, variable in dataset.variables.items():
        if name in UNITS:
            unit, long_name = UNITS[str(name)]
            variable.attrs = {"units": unit, "long_name": long_name}
    dataset.attrs = {
        "Conventions": "CF-1.11",
        "title": f"hitjoints: {robot.title}",
        "source": f"hitjoints {__version__}",
        "robot": robot.name,
        "robot_digest": robot.digest,
        **parameters,
    }
    return dataset
