"""Recorded hits beside the model: one, a folder, or thousands."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from hitjoints.errors import HitjointsError, InputError
from hitjoints.evidence.recordings.hit_files import EXAMPLES, ROBOT_FILE, FoundFiles, find
from hitjoints.evidence.recordings.layout import read_robot
from hitjoints.evidence.recordings.measure import measure, predict
from hitjoints.evidence.recordings.motion import model_along
from hitjoints.evidence.recordings.replayed_hit import ReplayedHit
from hitjoints.evidence.recordings.shown_mass import (
    CONTACT,
    FittedStiffness,
    check_drives,
    fit_stiffness,
    with_models,
)
from hitjoints.loading.catalogue import robot_names
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact, Robot
from hitjoints.plotted import Plotted
from hitjoints.told import Told
from hitjoints.vectors import positive_mass, unit

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.types import Array

TOOL = (0.0, 0.0, 0.15)
"""m: the point that hits in the public data set, in the last joint's frame."""

KNOWN = {"IIWA_7": ("iiwa7", (0.0, 1.0, 0.0)), "IIWA_14": ("iiwa14", (0.0, -1.0, 0.0))}
"""The recorder's names: the robot, and the direction it hits in."""

USUAL = "iiwa14"

REMARKS = {
    "restitution": "object_speed / flux - 1; the robot pushes on during the contact, so it may "
    "exceed that of the materials, even 1",
    "recorded_inertia": "of the recorder's own model, which carried an inertia at the flange that "
    "the arm does not have: not to be compared in kilograms",
    "momentum_mass": "mass object_speed / (robot_speed - robot_speed_after) exceeds the inertia, "
    "often severalfold, because the robot pushes on and its speed is filtered: no validation",
    "unpushed_mass": "the same with the push estimated from the robot's acceleration before the "
    "contact and after it; the motors behind elastic joints are still in it",
    "predicted_object_speed": "(1 + assumed_restitution) flux",
}


@dataclass(frozen=True, eq=False, repr=False)
class Replay(Told, Plotted):
    """Recorded hits beside the model: `hits`, one per robot's file, in the order of the files."""

    drawn_by: ClassVar[str] = "replay"

    hits: tuple[ReplayedHit, ...]

    @property
    def words(self) -> str:
        """What was replayed, in a line."""
        return f"{len(self.hits)} hits, {len(self.usable)} of them usable"

    def lines(self) -> list[tuple[str, object]]:
        """Return what of each hit counts."""
        return [(f"{one.file}, {one.robot}", "ok" if one.ok else one.reason) for one in self.hits]

    @cached_property
    def stiffness(self) -> FittedStiffness | None:
        """The joints' stiffness that explains the hits best; None where they do not tell."""
        return fit_stiffness(self.usable)

    @property
    def usable(self) -> tuple[ReplayedHit, ...]:
        """The hits that are ok."""
        return tuple(hit for hit in self.hits if hit.ok)

    @cached_property
    def dataset(self) -> Dataset:
        """All hits, with inertia, gradient and speed along each motion."""
        from hitjoints.evidence.recordings.dataset import hits_dataset

        return hits_dataset(self.hits)

    def as_dict(self) -> dict[str, Any]:
        """Return the result as JSON knows it."""
        return {
            "hits": [hit.as_dict() for hit in self.hits],
            "files": len(self.hits),
            "usable": len(self.usable),
            "stiffness": None if self.stiffness is None else self.stiffness._asdict(),
            "remarks": REMARKS,
        }


def replay(  # noqa: PLR0913
    paths: str | Path | Iterable[str | Path] | None = None,
    *,
    robot: Robot | str | Path | None = None,
    direction: ArrayLike | None = None,
    mass: float | None = None,
    offset: Sequence[float] = TOOL,
    restitution: float | None = None,
    impact: bool = False,
    contact_time: float = CONTACT,
    stiffness: ArrayLike | None = None,
    rotor_inertia: ArrayLike | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Replay:
    """Compare recorded hits with the model.

    Args:
        paths: robots' files (`..._hit_N.csv`, with `object_M_hit_N.csv` beside them), and folders,
            which are searched with the folders in them. None: four hits that come with hitjoints.
        robot: the arm; None: as each file says.
        direction: (3,) hitting direction; None: +y for the iiwa 7, -y for the iiwa 14, as they are
            recorded, else the axis nearest to the tool's velocity when it is fastest.
        mass: kg, of the object; None: what the recorded flux implies, else 0.4.
        offset: (3,) m, of the point that hits, in the last joint's frame.
        restitution: of the predicted object speed; None: the median of the other hits.
        impact: add what models of the drives say of each hit, and the stiffness that fits best.
        contact_time: s, of the rigid pair, for the elastic model.
        stiffness: for it, see `elastic_impact`.
        rotor_inertia: kg m^2, see `impact_inertia`; without it an arm whose rotors are not known
            has neither "rotor" nor "elastic".
        progress: called with the number of files done, and of all.

    Returns:
        The hits, one per robot's file. A file that cannot be used has `ok` False and a `reason`.

    Raises:
        InputError: an argument cannot be used.
        ModelError: the robot cannot be loaded.
    """
    if mass is not None:
        positive_mass(mass)
    if restitution is not None and not 0 <= restitution <= 1:
        raise InputError("restitution", restitution, "it must lie from 0 to 1")
    h = None if direction is None else unit(direction)
    if h is not None and h.ndim != 1:
        raise InputError("direction", direction, "one direction x,y,z")
    check_drives(contact_time, stiffness, rotor_inertia)
    drives = {
        "contact_time": contact_time, "stiffness": stiffness, "rotor_inertia": rotor_inertia
    }  # fmt: skip
    tool = Contact(1, tuple(offset)).offset  # type: ignore[arg-type]
    reader = _Reader(robot, h, mass, tool, drives if impact else None)
    asked = EXAMPLES if paths is None else paths
    found = find([Path(asked)] if isinstance(asked, (str, Path)) else map(Path, asked))
    hits = []
    for count, files in enumerate(found, start=1):
        hits.append(reader.hit(files))
        if progress is not None:
            progress(count, len(found))
    return Replay(predict(hits, restitution))


class _Reader:
    """Reads and measures one recording after another, with the robots loaded once."""

    def __init__(
        self,
        robot: Robot | str | Path | None,
        direction: Array | None,
        mass: float | None,
        offset: tuple[float, float, float],
        drives: dict[str, Any] | None,
    ) -> None:
        self.direction, self.mass, self.offset, self.drives = direction, mass, offset, drives
        self.given = (
            None if robot is None else robot if isinstance(robot, Robot) else load_robot(robot)
        )
        self.robots: dict[str, Robot] = {}

    def hit(self, found: FoundFiles) -> ReplayedHit:
        """Return what is in a file; problems end in the result."""
        name = None if self.given is None else self.given.name
        if found.problem:
            return ReplayedHit(str(found.file), name, reason=found.problem)
        try:
            recording = read_robot(found.file)
            title = recording.name or _named_by(found.file)
            known, along = KNOWN.get(title, (title.lower(), None))
            robot = self.given or self._robot(known)
            name = robot.name
            h = self.direction if self.direction is not None else along
            tool = Contact(robot.n, self.offset)
            motion = model_along(recording, robot, tool, None if h is None else np.array(h))
            hit = measure(found, recording, motion, name, self.mass)
            if self.drives is None or hit.contact_time is None:
                return hit
            now = float(recording.clock.time[0]) + hit.contact_time
            return with_models(hit, robot, motion.at(now, recording.q), tool, **self.drives)
        except HitjointsError as error:
            return ReplayedHit(str(found.file), name, reason=str(error))

    def _robot(self, name: str) -> Robot:
        if name not in self.robots:
            self.robots[name] = load_robot(name if name in robot_names() else USUAL)
        return self.robots[name]


def _named_by(file: Path) -> str:
    match = ROBOT_FILE.fullmatch(file.name)
    return match["robot"] if match else ""
