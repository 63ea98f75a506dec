"""Things in space on a flat axis: gathered, seen from one side, drawn the far ones first."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from hitjoints.types import Array

LIGHT = np.array([-0.35, 0.76, 0.55])
"""Where light comes from: to the right, up, towards us."""
DARKEST = 0.7
"""How bright a face is that is turned away from it."""
AROUND = 0.03
"""Of what is seen, left free on every side."""
FLOOR = "#E5E7EB"
TOP = 60  # above all solids


class Picture:
    """A parallel view of solids and lines.

    Args:
        azimuth: deg, from where it is seen, about the vertical from x.
        elevation: deg, above the horizon.
    """

    def __init__(self, azimuth: float = -60.0, elevation: float = 18.0) -> None:
        a, e = np.radians([azimuth, elevation])
        towards = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        self._axes = np.stack([right, np.cross(towards, right), towards])
        self._faces: list[Array] = []
        self._colours: list[Array] = []
        self._over: list[tuple[str, Array, dict[str, Any]]] = []

    def seen(self, points: Array) -> Array:
        """Return points (..., 3) m as they are seen: (..., 3), to the right, up, towards us."""
        return np.asarray(points @ self._axes.T)

    def solid(self, faces: Sequence[Array], colour: str, alpha: float = 1.0) -> None:
        """Add flat faces, each (k, 3) m; they are lit, unless they can be seen through."""
        from matplotlib.colors import to_rgb

        rgb = np.array(to_rgb(colour))
        for face in faces:
            normal = np.cross(face[1] - face[0], face[2] - face[0])
            size = float(np.linalg.norm(normal))
            if size < 1e-12:
                continue
            facing = self._axes @ normal / size
            lit = float((facing if facing[2] > 0 else -facing) @ LIGHT)
            bright = DARKEST + (1 - DARKEST) * max(0.0, lit)
            self._faces.append(face)
            self._colours.append(np.append(rgb * (bright if alpha == 1 else 1.0), alpha))

    def line(self, points: Array, **style: Any) -> None:
        """Add a line or marks over the solids: points (k, 3) m, style as matplotlib's `plot`."""
        self._over.append(("line", points, style))

    def arrow(self, begin: Array, end: Array, **style: Any) -> None:
        """Add an arrow over the solids, m."""
        self._over.append(("arrow", np.stack([begin, end]), style))

    def ground(self, corners: Array, colour: str) -> None:
        """Add a flat thing that all solids stand before, corners (k, 3) m."""
        self._over.append(("ground", corners, {"facecolor": colour, "alpha": 0.6}))

    def text(self, place: Array, words: str, **style: Any) -> None:
        """Write a word over the solids, centred at a place (3,) m."""
        self._over.append(("text", place[None], {"s": words, **style}))

    def edges(self, corners: Array, colour: str) -> None:
        """Add the edges of a box, corners (8, 3) m in the order of `product`."""
        pairs = [(i, j) for i in range(8) for j in (i | 1, i | 2, i | 4) if j > i]
        for i, j in pairs:
            self.line(corners[[i, j]], color=colour, lw=0.8)

    def bounds(self, *more: Array) -> Array:
        """Return what is in the picture, and more points (k, 3) m: [[left, right], [low, high]]."""
        parts = [*self._faces, *(points for _, points, _ in self._over), *more]
        seen = self.seen(np.vstack([part.reshape(-1, 3) for part in parts]))[:, :2]
        low, high = seen.min(axis=0), seen.max(axis=0)
        free = AROUND * float((high - low).max())
        return np.stack([low - free, high + free], axis=1)

    def draw(self, axis: Any, bounds: Array | None = None) -> None:
        """Draw it on an axis, which shows nothing else then.

        Args:
            axis: a flat one of matplotlib's.
            bounds: as `bounds` returns; by default of what is in the picture.
        """
        from matplotlib.collections import PolyCollection

        bounds = self.bounds() if bounds is None else bounds
        seen = [self.seen(face) for face in self._faces]
        order = np.argsort([float(face[:, 2].mean()) for face in seen], kind="stable")
        colours = np.array(self._colours).reshape(-1, 4)[order]
        # An edge of its own colour hides the seam to the next face; one that is seen through
        # would be twice as dark there.
        edges = np.where(colours[:, 3:] == 1, colours, 0.0)
        axis.add_collection(
            PolyCollection(
                [seen[i][:, :2] for i in order], facecolors=colours, edgecolors=edges,
                linewidths=0.4, zorder=10,
            )
        )  # fmt: skip
        for kind, points, style in self._over:
            flat = self.seen(points)[:, :2]
            if kind == "line":
                axis.plot(*flat.T, **{"zorder": TOP, **style})
            elif kind == "ground":
                axis.fill(*flat.T, **{"zorder": 2, "edgecolor": "none", **style})
            elif kind == "text":
                axis.text(*flat[0], ha="center", va="center", zorder=TOP, **style)
            else:
                axis.annotate(
                    "", flat[1], flat[0], zorder=TOP + 10,
                    arrowprops={"arrowstyle": "-|>", "shrinkA": 0, "shrinkB": 0, **style},
                )  # fmt: skip
        axis.set(xlim=bounds[0], ylim=bounds[1])
        axis.set_aspect("equal", adjustable="box", anchor="C")
        axis.set_axis_off()

    def floor(self, low: Array, high: Array, height: float, apart: float) -> None:
        """Add a grid on a level plane: from (2,) m to (2,) m, lines so far apart."""
        x, y = (np.arange(a, b + apart / 2, apart) for a, b in zip(low, high, strict=True))
        for value in x:
            ends = np.array([[value, y[0], height], [value, y[-1], height]])
            self.line(ends, color=FLOOR, lw=0.8, zorder=1)
        for value in y:
            ends = np.array([[x[0], value, height], [x[-1], value, height]])
            self.line(ends, color=FLOOR, lw=0.8, zorder=1)
