"""Analytical dynamics for hitting objects with different joints of a robot arm."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from hitjoints.version import __version__

if TYPE_CHECKING:
    from hitjoints.dynamics.impact import hitting_flux, object_speed, rebound, required_speed
    from hitjoints.dynamics.inertia import inverse_inertia
    from hitjoints.dynamics.kinematics import (
        FeasibleDirections,
        feasible_directions,
        jacobian,
        manipulability,
        position,
    )
    from hitjoints.errors import (
        HitjointsError,
        InfeasibleError,
        InputError,
        ModelError,
        SolverError,
    )
    from hitjoints.evidence.paper.reproduce import reproduce
    from hitjoints.evidence.physics.simulation import simulate
    from hitjoints.evidence.recordings.replay import replay
    from hitjoints.hitting.controller import Controller
    from hitjoints.hitting.hit import Hit
    from hitjoints.hitting.rollout import rollout
    from hitjoints.loading import ModelWarning, load_robot, robot_names
    from hitjoints.maps.joint_sweep import sweep_joint
    from hitjoints.maps.workspace import open_map, sweep_workspace
    from hitjoints.planning.clearance import clearance
    from hitjoints.planning.feasibility import learn_feasibility, load_feasibility
    from hitjoints.planning.plan import plan
    from hitjoints.planning.posture import posture
    from hitjoints.planning.start import plan_start
    from hitjoints.planning.surroundings import Surroundings
    from hitjoints.quantities import (
        directional_inertia,
        directional_inertia_gradient,
        hitting_speed,
        place_joint,
    )
    from hitjoints.robot import Contact, Robot
    from hitjoints.show.viewer import view

# Where each public name lives. Loaded on first use: `import hitjoints` costs milliseconds.
_HOMES = {
    "dynamics.impact": ("hitting_flux", "object_speed", "rebound", "required_speed"),
    "dynamics.inertia": ("inverse_inertia",),
    "dynamics.kinematics": (
        "FeasibleDirections",
        "feasible_directions",
        "jacobian",
        "manipulability",
        "position",
    ),
    "errors": ("HitjointsError", "InfeasibleError", "InputError", "ModelError", "SolverError"),
    "evidence.paper.reproduce": ("reproduce",),
    "evidence.physics.simulation": ("simulate",),
    "evidence.recordings.replay": ("replay",),
    "hitting.controller": ("Controller",),
    "hitting.hit": ("Hit",),
    "hitting.rollout": ("rollout",),
    "loading": ("ModelWarning", "load_robot", "robot_names"),
    "maps.joint_sweep": ("sweep_joint",),
    "maps.workspace": ("open_map", "sweep_workspace"),
    "planning.clearance": ("clearance",),
    "planning.feasibility": ("learn_feasibility", "load_feasibility"),
    "planning.plan": ("plan",),
    "planning.posture": ("posture",),
    "planning.start": ("plan_start",),
    "planning.surroundings": ("Surroundings",),
    "quantities": (
        "directional_inertia",
        "directional_inertia_gradient",
        "hitting_speed",
        "place_joint",
    ),
    "robot": ("Contact", "Robot"),
    "show.viewer": ("view",),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}

__all__ = [
    "Contact",
    "Controller",
    "FeasibleDirections",
    "Hit",
    "HitjointsError",
    "InfeasibleError",
    "InputError",
    "ModelError",
    "ModelWarning",
    "Robot",
    "SolverError",
    "Surroundings",
    "__version__",
    "clearance",
    "directional_inertia",
    "directional_inertia_gradient",
    "feasible_directions",
    "hitting_flux",
    "hitting_speed",
    "inverse_inertia",
    "jacobian",
    "learn_feasibility",
    "load_feasibility",
    "load_robot",
    "manipulability",
    "object_speed",
    "open_map",
    "place_joint",
    "plan",
    "plan_start",
    "position",
    "posture",
    "rebound",
    "replay",
    "reproduce",
    "required_speed",
    "robot_names",
    "rollout",
    "simulate",
    "sweep_joint",
    "sweep_workspace",
    "view",
]


def __getattr__(name: str) -> Any:
    if name not in _HOME_OF:
        raise AttributeError(f"module 'hitjoints' has no attribute {name!r}")
    value = getattr(import_module(f"hitjoints.{_HOME_OF[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
