"""Learn where a joint can produce a flux, and in which configurations (Section V of the paper).

For one contact and one object mass, sweeps give the greatest flux (Eq. 10) at random positions and
directions, and the configuration that has it. From them come

- the probability that the contact can produce a flux here: a small neural network;
- configurations to start a search from: the best ones of the most similar hits of the sweep,
  turned about the base and placed by inverse kinematics. The table is the distribution: a Gaussian
  mixture fitted to it proposed configurations hardly better than random ones, and is not kept.

An arm whose joint 1 turns about the vertical through the base's origin looks the same from every
side; only joint 1's limits differ. Hits are then told apart by radius, height and the direction in
the vertical plane through the position.

What it is worth (`benchmarks/learning.py`, iiwa14, joints 5 to 7): 97 % of the answers right, and
20 to 200 times fewer configurations tried until, in nine hits of ten, one is within 1 % of the
greatest flux (at joint 7 random search does not get there with 2048). It hardly saves time: a call
of the batched inverse kinematics costs about 2 ms for one configuration as for a thousand, so the
two searches take about equally long.

Training needs scikit-learn, the answers do not.
"""

from __future__ import annotations

import json
import warnings
import zipfile
from dataclasses import dataclass, field
from functools import cached_property
from importlib import import_module, metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.datasets.describe import origin
from hitjoints.datasets.files import check_writable, write_whole
from hitjoints.errors import InfeasibleError, InputError, MissingExtraError
from hitjoints.model.robot import Contact
from hitjoints.planning.learning.similar_hits import features, turned
from hitjoints.planning.learning.swept_hits import LEAST_SCALE, hits_of_map, sampled_hits
from hitjoints.quantities import place_joint
from hitjoints.vectors import points, real, unit

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.model.robot import Robot
    from hitjoints.types import Array

ENDINGS = (".npz",)
FLUXES = 41  # from 0 to twice the greatest asked about, at which the network is asked
QUESTIONS = 3  # fluxes asked about per hit of the sweep
NETWORK: dict[str, Any] = {
    "hidden_layer_sizes": (64, 64), "max_iter": 30, "batch_size": 512,
    "learning_rate_init": 2e-3, "early_stopping": True,
}  # fmt: skip


def _falling(values: Array) -> Array:
    """Return rows of probabilities (N, K) over rising fluxes so that none rises.

    Who can produce a flux can produce a lesser one; a network does not know. What it says of all
    lesser fluxes bounds a probability from above, what it says of all greater ones from below:
    the answer lies in the middle.
    """
    least = np.minimum.accumulate(values, axis=1)
    most = np.maximum.accumulate(values[:, ::-1], axis=1)[:, ::-1]
    return 0.5 * (least + most)


@dataclass(frozen=True, eq=False)
class Feasibility:
    """What was learnt about one contact of one robot; made by `learn_feasibility`.

    Attributes:
        robot: the arm.
        contact: what hits.
        mass: of the object, kg.
        hits: (T, F), of the sweep: position and direction, turned into the vertical plane of the
            position where the arm allows it.
        q: (T, n) rad, the best configuration of each hit, turned likewise.
        layers: weights (i, o) and offsets (o,) of the network in turn.
        centre: (F + 1,), of the network's inputs, a hit and a flux.
        scale: (F + 1,), of the same.
        provenance: seed, sizes and versions it was trained with.
    """

    robot: Robot
    contact: Contact
    mass: float
    hits: Array = field(repr=False)
    q: Array = field(repr=False)
    layers: tuple[Array, ...] = field(repr=False)
    centre: Array = field(repr=False)
    scale: Array = field(repr=False)
    provenance: dict[str, Any]

    def probability(self, position: ArrayLike, direction: ArrayLike, flux: ArrayLike) -> Any:
        """Return the probability that the contact can produce a flux at a position.

        Args:
            position: (3,) or (N, 3) m.
            direction: (3,) or (N, 3).
            flux: m/s, a number or (N,).

        Returns:
            From 0 to 1: a float, or (N,).

        Raises:
            InputError: an argument cannot be used.
        """
        at, h = points(position, "position"), unit(direction)
        try:
            wanted = real(flux, "flux", "one number, or one per position")
            at, h, _ = np.broadcast_arrays(at, h, wanted[..., None])
        except (TypeError, ValueError):
            raise InputError("flux", flux, "one number, or one per position") from None
        if not np.isfinite(wanted).all():
            raise InputError("flux", flux, "it must be finite")
        rows, _ = features(self.robot, at.reshape(-1, 3), h.reshape(-1, 3))
        fluxes = np.linspace(0.0, 4.0 * self.centre[-1], FLUXES)
        falling = _falling(np.stack([self._network(rows, one) for one in fluxes], axis=1))
        asked = np.broadcast_to(wanted, at.shape[:-1]).ravel()
        found = np.array(
            [np.interp(one, fluxes, row) for one, row in zip(asked, falling, strict=True)]
        )
        return found if at.ndim == 2 else float(found[0])

    def _network(self, hits: Array, flux: float) -> Array:
        """Return what the network says of hits (N, F) and a flux, (N,)."""
        x = np.column_stack([hits, np.full(len(hits), flux)])
        x = (x - self.centre) / self.scale
        for weights, offsets in zip(self.layers[:-2:2], self.layers[1:-2:2], strict=True):
            x = np.maximum(x @ weights + offsets, 0.0)
        last = (x @ self.layers[-2] + self.layers[-1])[:, 0]
        return np.asarray(0.5 * (1.0 + np.tanh(0.5 * last)))

    def propose(
        self, position: ArrayLike, direction: ArrayLike, count: int = 16, seed: int = 0
    ) -> Array:
        """Return configurations that put the contact at a position, likely ones for a high flux.

        Args:
            position: (3,) m.
            direction: (3,).
            count: how many similar hits to start from, at least 1.
            seed: of the inverse kinematics' restarts.

        Returns:
            (M, n) rad within the limits, M <= count, the most similar hit's first; (0, n) when the
            position is out of reach.

        Raises:
            InputError: an argument cannot be used.
        """
        at, h = points(position, "position"), unit(direction)
        if at.shape != (3,) or h.shape != (3,):
            raise InputError("position", f"shape {at.shape}", "one position and one direction")
        if count < 1:
            raise InputError("count", count, "at least 1")
        rows, azimuth = features(self.robot, at[None], h[None])
        table, squares = self._table
        away = squares - 2.0 * (table @ (rows[0] / self.scale[:-1]))
        count = min(count, len(away))
        nearest = np.argpartition(away, count - 1)[:count]
        nearest = nearest[np.argsort(away[nearest], kind="stable")]
        start = turned(self.robot, self.q[nearest], np.repeat(azimuth, count))
        placed = place_joint(self.robot, self.contact, np.tile(at, (count, 1)), seed, start=start)
        return np.asarray(placed.q[placed.solved])

    @cached_property
    def _table(self) -> tuple[Array, Array]:
        """The hits in units of their spread, (T, F), and their squared lengths (T,)."""
        table = self.hits / self.scale[:-1]
        return table, (table**2).sum(axis=1)

    def save(self, path: Path) -> None:
        """Write all of it into one NPZ file: arrays, and the rest as JSON.

        Raises:
            InputError: the path does not end in .npz or cannot be written.
        """
        check_writable(path, "out", ENDINGS)
        attributes = {
            "robot": self.robot.name,
            "digest": self.robot.digest,
            "joint": self.contact.joint,
            "offset": self.contact.offset,
            "mass": self.mass,
            "provenance": self.provenance,
        }
        arrays: dict[str, Any] = {f"layer_{i}": layer for i, layer in enumerate(self.layers)}
        arrays |= {name: getattr(self, name) for name in ("hits", "q", "centre", "scale")}
        arrays["attributes"] = np.array(json.dumps(attributes))

        def write(scratch: Path) -> None:
            with scratch.open("wb") as file:
                np.savez_compressed(file, **arrays)

        write_whole(path, "out", write)


def load_feasibility(path: Path, robot: Robot) -> Feasibility:
    """Read what `Feasibility.save` wrote.

    Args:
        path: of the file.
        robot: the arm that it was learnt with.

    Raises:
        InputError: no such file, not one of these, or learnt with another robot.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        found = json.loads(str(arrays.pop("attributes")))
        layers = tuple(arrays.pop(f"layer_{i}") for i in range(found["provenance"]["layers"]))
        contact = Contact(found["joint"], tuple(found["offset"]))
        learnt, mass, provenance = found["digest"], found["mass"], found["provenance"]
        values = {name: arrays[name] for name in ("hits", "q", "centre", "scale")}
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile) as error:
        raise InputError(
            "path", path, f"a file of learnt feasibility is needed ({error})"
        ) from None
    if learnt != robot.digest:
        raise InputError("path", path, f"it was learnt with another robot than {robot.name}")
    return Feasibility(robot, contact, mass, layers=layers, provenance=provenance, **values)


def learn_feasibility(
    robot: Robot,
    contact: Contact | int,
    mass: float,
    *,
    positions: int = 6000,
    directions: int = 8,
    samples: int = 128,
    seed: int = 0,
    swept: Dataset | None = None,
) -> Feasibility:
    """Sweep the workspace of a contact and learn from it, or learn from a map.

    Args:
        robot: the arm.
        contact: joint number or Contact.
        mass: of the object, kg.
        positions: how many to sweep, at least 20.
        directions: random directions per position, at least 1.
        samples: configurations per position, at least 1.
        seed: of everything random. Same seed, same result.
        swept: a map of `sweep_workspace`, or of `sweep_motion`: then what is learnt is the flux
            that a motion delivers. It should span the positions and directions to be asked about.

    Raises:
        InputError: an argument cannot be used.
        InfeasibleError: the contact cannot produce any flux anywhere.
        MissingExtraError: scikit-learn is not installed.
    """
    try:
        network = import_module("sklearn.neural_network").MLPClassifier
        limit_threads = import_module("threadpoolctl").threadpool_limits
    except ImportError:
        raise MissingExtraError("scikit-learn", "learn") from None
    contact = robot.contact(contact)
    counts: dict[str, Any] = {"positions": positions, "directions": directions, "samples": samples}
    for name, least in (("positions", 20), ("directions", 1), ("samples", 1)):
        if counts[name] < least:
            raise InputError(name, counts[name], f"at least {least}")
    rng = np.random.default_rng(seed)
    if swept is None:
        found = sampled_hits(robot, contact, mass, (positions, directions, samples), rng, seed)
    else:
        found = hits_of_map(robot, contact, mass, swept)
        counts = {"map": swept.attrs.get("command") or "swept", "hits": len(found.flux)}
    flux, reached = found.flux, np.flatnonzero(found.flux > 0)
    if reached.size < 2:
        raise InfeasibleError(f"joint {contact.joint} of {robot.name} cannot produce any flux")
    hits, azimuth = features(robot, found.at, found.h)
    q = turned(robot, found.q[reached], -azimuth[reached], limited=False)
    top = 1.05 * float(np.quantile(flux[reached], 0.99))
    asked = rng.uniform(0.0, top, QUESTIONS * len(flux))
    x = np.column_stack([np.tile(hits, (QUESTIONS, 1)), asked])
    centre, spread = x.mean(axis=0), np.maximum(x.std(axis=0), LEAST_SCALE)
    able = (np.tile(flux, QUESTIONS) >= asked).astype(int)
    # The batches are small: threads would only wait for each other. The iterations are a budget.
    with limit_threads(1), warnings.catch_warnings(category=UserWarning, action="ignore"):
        trained = network(random_state=seed, **NETWORK).fit((x - centre) / spread, able)
    layers = tuple(
        part for pair in zip(trained.coefs_, trained.intercepts_, strict=True) for part in pair
    )
    provenance = {
        "seed": seed, **counts, "layers": len(layers),
        "scikit-learn": metadata.version("scikit-learn"), **origin(robot),
    }  # fmt: skip
    return Feasibility(robot, contact, mass, hits[reached], q, layers, centre, spread, provenance)
