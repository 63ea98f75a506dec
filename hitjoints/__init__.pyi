"""Where each public name lives: the one list of them. Loaded on first use."""

from .answers.answer import answer as answer
from .answers.answer_record import Answer as Answer
from .c_source import c_source as c_source
from .dynamics.inertia import inverse_inertia as inverse_inertia
from .dynamics.kinematics import (
    FeasibleDirections as FeasibleDirections,
)
from .dynamics.kinematics import (
    feasible_directions as feasible_directions,
)
from .dynamics.kinematics import (
    jacobian as jacobian,
)
from .dynamics.kinematics import (
    manipulability as manipulability,
)
from .dynamics.kinematics import (
    position as position,
)
from .errors import (
    HitjointsError as HitjointsError,
)
from .errors import (
    InfeasibleError as InfeasibleError,
)
from .errors import (
    InputError as InputError,
)
from .errors import (
    ModelError as ModelError,
)
from .errors import (
    SolverError as SolverError,
)
from .evaluator import Evaluator as Evaluator
from .evidence.calibration.past_hits import calibrate as calibrate
from .evidence.paper.reproduction import reproduce as reproduce
from .evidence.physics.simulation import simulate as simulate
from .evidence.recordings.replayer import replay as replay
from .goals.landing import Landing as Landing
from .goals.landing import landing as landing
from .hit import Hit as Hit
from .hit_loading import load_hit as load_hit
from .hit_setting import HitSetting as HitSetting
from .hit_setting import RobotChoice as RobotChoice
from .hitting.controller import Controller as Controller
from .hitting.drive_limits import DriveLimits as DriveLimits
from .impact.collision import (
    hitting_flux as hitting_flux,
)
from .impact.collision import (
    object_speed as object_speed,
)
from .impact.collision import (
    rebound as rebound,
)
from .impact.collision import (
    required_speed as required_speed,
)
from .impact.drives import Drives as Drives
from .impact.elastic import elastic_impact as elastic_impact
from .impact.inertia_models import impact_inertia as impact_inertia
from .impact.inertia_models import impact_inertia_gradient as impact_inertia_gradient
from .loading.catalogue import robot_names as robot_names
from .loading.load import (
    ModelWarning as ModelWarning,
)
from .loading.load import (
    load_robot as load_robot,
)
from .maps.contact_time_sweep import sweep_contact_time as sweep_contact_time
from .maps.joint_sweep import sweep_joint as sweep_joint
from .maps.mass_sweep import sweep_mass as sweep_mass
from .maps.motion_sweep import sweep_motion as sweep_motion
from .maps.run_sweep import open_map as open_map
from .maps.workspace import sweep_workspace as sweep_workspace
from .model.robot import Contact as Contact
from .model.robot import Robot as Robot
from .model.tool import Tool as Tool
from .planning.learning.feasibility import (
    learn_feasibility as learn_feasibility,
)
from .planning.learning.feasibility import (
    load_feasibility as load_feasibility,
)
from .planning.plan_file import load_plan as load_plan
from .planning.planner import plan as plan
from .planning.posture import posture as posture
from .planning.room.clearance import clearance as clearance
from .planning.room.surroundings import Surroundings as Surroundings
from .planning.start import plan_start as plan_start
from .quantities import (
    directional_inertia as directional_inertia,
)
from .quantities import (
    directional_inertia_gradient as directional_inertia_gradient,
)
from .quantities import (
    hitting_speed as hitting_speed,
)
from .quantities import (
    place_joint as place_joint,
)
from .rollouts.follow import rollout as rollout
from .rollouts.many_record import Rollouts as Rollouts
from .rollouts.side_by_side import rollouts as rollouts
from .show import figures as figures
from .show.viewer.open_viewer import view as view
from .swings.make_swing import swing as swing
from .swings.swing_record import Swing as Swing
from .version import __version__ as __version__
