"""What a simulated hit leaves behind: prediction, result, causes of the difference, data set."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hitjoints.datasets.describe import origin, versions
from hitjoints.evidence.physics.slide import turned
from hitjoints.goals.box_rest import rest_at
from hitjoints.plotted import Plotted
from hitjoints.told import Told

if TYPE_CHECKING:
    from xarray import Dataset

    from hitjoints.evidence.physics.first_touch import ImpactState
    from hitjoints.evidence.physics.setting import EngineSetting, Mode
    from hitjoints.evidence.physics.slide import Slide
    from hitjoints.evidence.physics.strike import Strike
    from hitjoints.goals.box_rest import BoxRest
    from hitjoints.impact.elastic import ElasticImpact
    from hitjoints.rollouts.record import Rollout

COMPARED = ("object_speed", "rebound", "inertia")
VARIABLES: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "time": ("s", "time since the arm stands before the box", ("time",)),
    "robot_speed": ("m/s", "speed of the contact point along the hitting direction", ("time",)),
    "object_speed": ("m/s", "speed of the box's centre along the hitting direction", ("time",)),
    "force": ("N", "force between arm and box along the contact's normal", ("time",)),
    "q": ("rad", "joint positions (m for a prismatic joint)", ("time", "axis")),
    "box_position": ("m", "centre of the box, robot base frame", ("time", "coordinate")),
    "box_quaternion": ("1", "orientation of the box: w, x, y, z", ("time", "component")),
    "slide_time": ("s", "time since the box slides alone", ("slide_time",)),
    "slide_position": ("m", "centre of the box, robot base frame", ("slide_time", "coordinate")),
    "slide_quaternion": ("1", "orientation of the box: w, x, y, z", ("slide_time", "component")),
    "slide_speed": ("m/s", "speed of the box's centre along the direction", ("slide_time",)),
}
"""Unit, long name and dimensions of every variable of the data set."""


@dataclass(frozen=True)
class Prediction:
    """What the model says beforehand.

    Attributes:
        object_speed: m/s, (1 + eps) phi (Eq. 3).
        rebound: m/s, negative (Eq. 11).
        inertia: kg, lambda at the impact.
        travel: m, v^2 / (2 mu g); None where the box does not slide on a table with friction.
        flux: m/s, at the impact.
        speed: m/s, at the impact.
    """

    object_speed: float
    rebound: float
    inertia: float
    travel: float | None
    flux: float
    speed: float


@dataclass(frozen=True, eq=False)
class Cause:
    """Something that is not as the model has it: the hit with it alone, and with all but it."""

    name: str
    value: float
    alone: Strike
    without: Strike


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Told, Plotted):
    """A planned hit, predicted and simulated.

    Attributes:
        motion: the rollout to the impact.
        mode: how it was made in the engine.
        setting: how it was made in the engine.
        impact: the state at the first touch.
        predicted: by the model.
        strike: by the engine, until arm and box part.
        slide: until the box rests; None where it does not slide on a table with friction.
        causes: of the difference, those that are in the setting.
        elastic: what elastic joints make of it in closed form; None where joints are rigid.
        predicted_rest: where the box should come to rest; None where it does not simply slide.
        unpredicted: why it does not.
    """

    drawn_by: ClassVar[str] = "simulation"

    motion: Rollout
    mode: Mode
    setting: EngineSetting
    impact: ImpactState
    predicted: Prediction
    strike: Strike
    slide: Slide | None
    causes: tuple[Cause, ...] = field(repr=False)
    elastic: ElasticImpact | None = None
    predicted_rest: BoxRest | None = None
    unpredicted: str = ""

    @cached_property
    def rest(self) -> BoxRest | None:
        """Where the box came to rest in the engine; None where it does not slide on a table."""
        if self.slide is None:
            return None
        way = self.slide.rows["slide_position"][-1] - self.impact.box_centre(self.setting)
        return rest_at(
            self.motion.hit,
            way[:2],
            yaw=turned(self.strike.rows["box_quaternion"]) + self.slide.turned,
            speed=float(np.hypot(*self.strike.velocity[:2])),
            spin=self.strike.spin,
            tipped=self.slide.tipped,
        )

    @property
    def travel(self) -> float | None:
        """How far the box's centre went along the direction until it rested, m."""
        if self.slide is None:
            return None
        way = self.slide.rows["slide_position"][-1] - self.impact.box_centre(self.setting)
        return float(self.impact.direction @ way)

    @property
    def words(self) -> str:
        """What it comes to, in a line."""
        joint, off = self.impact.contact.joint, 100 * self.errors_of(self.strike)["object_speed"]
        return (
            f"{self.motion.robot.name}, joint {joint}, {self.mode}: the object leaves with "
            f"{self.strike.object_speed:.4g} m/s, {off:+.2g} % of {self.predicted.object_speed:.4g}"
        )

    def lines(self) -> list[tuple[str, object]]:
        """Return what was predicted and what came of it."""
        told = asdict(self.predicted)
        return [
            (name, value if told.get(name) is None else f"{value:.4g}, predicted {told[name]:.4g}")
            for name, value in self.simulated.items()
            if value is not None
        ]

    @property
    def simulated(self) -> dict[str, float | None]:
        """What the engine says, by name."""
        names = (*COMPARED, "restitution", "contact_time", "contacts")
        return {name: getattr(self.strike, name) for name in names} | {"travel": self.travel}

    @property
    def elastic_errors(self) -> dict[str, float] | None:
        """Simulated less the closed form of elastic joints, as a share.

        The object's speed as a share of itself, the robot's as a share of the speed of the hit.
        """
        if self.elastic is None:
            return None
        speed = self.predicted.speed
        robot_speed = self.strike.rebound + speed
        return {
            "object_speed": self.strike.object_speed / self.elastic.object_speed - 1,
            "robot_speed": (robot_speed - self.elastic.robot_speed) / speed,
        }

    @property
    def errors(self) -> dict[str, float | None]:
        """Simulated over predicted, less 1."""
        found: dict[str, float | None] = dict(self.errors_of(self.strike))
        told, travel = self.predicted.travel, self.travel
        return found | {"travel": None if told is None or travel is None else travel / told - 1}

    def errors_of(self, strike: Strike) -> dict[str, float]:
        """Return an engine's result over the predicted, less 1."""
        return {
            name: getattr(strike, name) / getattr(self.predicted, name) - 1 for name in COMPARED
        }

    @cached_property
    def dataset(self) -> Dataset:
        """Arm and box through the contact along `time`, the box's way along `slide_time` (s)."""
        import xarray as xr

        rows = self.strike.rows | ({} if self.slide is None else self.slide.rows)
        along = {}
        for name, values in rows.items():
            unit, words, dimensions = VARIABLES[name]
            along[name] = (dimensions, values, {"units": unit, "long_name": words})
        attributes = origin(self.motion.robot) | {"mode": self.mode, "mass": self.impact.mass}
        attributes["hit"] = self.motion.parameters["hit"]
        attributes |= {name: _plain(value) for name, value in asdict(self.setting).items()}
        for kind, said in (("predicted", asdict(self.predicted)), ("simulated", self.simulated)):
            attributes |= {f"{kind}_{k}": v for k, v in said.items() if v is not None}
        return xr.Dataset(along, attrs=attributes)

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it."""
        at = self.motion.impact
        assert at is not None
        told, rest = self.predicted_rest, self.rest
        return {
            "asked": json.loads(self.motion.parameters["hit"]),
            "made_with": versions(),
            "hit": True,
            "reason": "",
            "mode": self.mode,
            "restitution": self.setting.restitution,
            "contact_time": self.setting.contact_time,
            "predicted": asdict(self.predicted),
            "simulated": self.simulated,
            "errors": self.errors,
            "elastic": None if self.elastic is None else self.elastic.as_dict(),
            "elastic_errors": self.elastic_errors,
            "rest": {
                "predicted": told and told.as_dict(),
                "reason": self.unpredicted,
                "simulated": rest and rest.as_dict(),
                "miss": rest.miss(told) if rest and told else None,
            },
            "shares": [
                {
                    "cause": cause.name,
                    "value": cause.value,
                    "alone": self.errors_of(cause.alone),
                    "without": self.errors_of(cause.without),
                }
                for cause in self.causes
            ],
            "setting": {name: _plain(value) for name, value in asdict(self.setting).items()},
            "impact": {
                "q": at.q.tolist(),
                "qd": self.impact.qd.tolist(),
                "position": at.position.tolist(),
                "miss": at.miss,
                "direction_error": at.direction_error,
            },
        }


def _plain(value: Any) -> Any:
    return list(value) if isinstance(value, tuple) else value
