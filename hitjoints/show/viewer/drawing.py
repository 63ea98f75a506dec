"""The things in the browser's scene, put where the stage says they are."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import inertia_along, inverse_inertia
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError
from hitjoints.show.drawn_arm import BOX, INERTIA, rgb
from hitjoints.show.inertia_surface import inertia_surface
from hitjoints.show.style import colour_of
from hitjoints.show.viewer.landing_mark import LandingMark, quaternion
from hitjoints.show.viewer.solids import solids

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from hitjoints.show.viewer.stage import Stage

RED, SHADE = "#e03131", "#8b97a7"
POINT = 0.018  # m, radius of the contact
GLASS = 0.82  # opacity of the links: a joint's origin lies inside its link
AXIS = 0.35  # m, of the base frame's axes
AHEAD = 0.3  # m, from the object to the tip of a direction's arrow


class Drawing:
    """Draws a stage.

    Args:
        scene: viser's.
        stage: what is drawn.

    Attributes:
        stage: what is drawn.
        scale: what the surface of the inertia is, with its scale; empty where there is none.
    """

    def __init__(self, scene: Any, stage: Stage) -> None:
        self._scene, self.stage, self.scale = scene, stage, ""
        scene.set_up_direction("+z")
        scene.add_grid("/floor", 3.0, 3.0, cell_size=0.1, section_size=0.5, fade_distance=8.0)
        self._draw_axes()
        shapes = solids(stage.robot)
        self._carriers = [(one.joint, one.placement) for one in shapes]
        self._links = [
            scene.add_mesh_simple(
                f"/arm/{one.name}", one.vertices, one.faces, color=rgb(SHADE), opacity=GLASS
            )
            for one in shapes
        ]
        self._red = np.zeros(stage.robot.n, bool)
        self._contact = scene.add_icosphere("/contact", POINT)
        self._said = scene.add_label("/contact_label", "", anchor="bottom-right")
        self._box = scene.add_box("/box", rgb(BOX), (1.0, 1.0, 1.0))
        self._weight = scene.add_label("/box_label", "", anchor="bottom-left")
        self._surface: Any = None
        self._landing = LandingMark(scene, stage)

    def wish(self) -> None:
        """Draw what follows from the wish and the plan alone: box, arrow, landing."""
        stage, box = self.stage, self.stage.begin
        colour = rgb(colour_of(stage.contact.joint))
        self._contact.color = tuple(round(255 * c) for c in colour)
        self._box.dimensions = tuple(map(float, box.size))
        h = stage.wish.direction
        begin = box.centre + np.abs(box.axes.T @ h) @ box.size / 2 * h
        tip = aim_point(stage)
        if float((tip - begin) @ h) < POINT:
            begin = tip - POINT * h
        self._scene.add_arrows(
            "/direction",
            np.array([[begin, tip]]),
            (20, 20, 20),
            shaft_radius=0.005,
            head_radius=0.015,
            head_length=0.04,
        )
        self._landing.draw()
        self.moment()

    def moment(self) -> None:
        """Draw what changes with the configuration and the time."""
        stage = self.stage
        robot, data = stage.robot, stage.robot.data
        pin.forwardKinematics(robot.model, data, stage.q)
        for link, (joint, placement) in zip(self._links, self._carriers, strict=True):
            at = data.oMi[joint] * placement
            link.position, link.wxyz = at.translation, quaternion(at.rotation)
        self._colour_links()
        here = position(robot, stage.q, stage.contact)
        self._contact.position = here
        self._said.position = here + np.array((0.0, 0.0, 0.06))
        self._said.text = self._words()
        box = stage.box
        self._box.position, self._box.wxyz = box.centre, quaternion(box.axes)
        up = np.abs(box.axes[2]) @ box.size / 2
        ahead = np.abs(box.axes.T @ stage.wish.direction) @ box.size / 2 * stage.wish.direction
        self._weight.position = box.centre + ahead + np.array((0, 0, up))
        self._weight.text = f"{stage.wish.mass:g} kg"
        self._draw_inertia(here)

    def _words(self) -> str:
        stage = self.stage
        joint = f"joint {stage.contact.joint}"
        try:
            inertia = inertia_along(stage.robot, stage.q, stage.contact, stage.wish.direction)
        except InfeasibleError:
            return f"{joint}: cannot move this way"
        return f"{joint}: {inertia:.2f} kg"

    def _colour_links(self) -> None:
        """Make the links red that hang on a joint at a limit."""
        red = self.stage.at_limit
        for link, (joint, _) in zip(self._links, self._carriers, strict=True):
            if joint and red[joint - 1] != self._red[joint - 1]:
                shade = rgb(RED if red[joint - 1] else SHADE)
                link.color = tuple(round(255 * c) for c in shade)
        self._red = red

    def _draw_inertia(self, here: NDArray[np.float64]) -> None:
        stage = self.stage
        drawn = inertia_surface(inverse_inertia(stage.robot, stage.q, stage.contact))
        self.scale = "" if drawn is None else drawn[1]
        if drawn is None:
            if self._surface is not None:
                self._surface.visible = False
            return
        points = drawn[0].reshape(-1, 3).astype(np.float32)
        if self._surface is None:
            self._surface = self._scene.add_mesh_simple(
                "/inertia",
                points,
                grid_faces(*drawn[0].shape[:2]),
                color=rgb(INERTIA),
                opacity=0.35,
                side="double",
                cast_shadow=False,
            )
        self._surface.vertices, self._surface.position = points, here
        self._surface.visible = True

    def _draw_axes(self) -> None:
        self._scene.add_frame("/axes", axes_length=AXIS, axes_radius=0.004)
        for name, end in zip("xyz", AXIS * np.eye(3), strict=True):
            self._scene.add_label(f"/axes/{name}", name, position=1.08 * end)
        for mark in (0.5, 1.0):
            for name, at in (("x", (mark, 0, 0)), ("y", (0, mark, 0))):
                self._scene.add_label(f"/floor/{name}{mark:g}", f"{mark:g} m", position=at)


def aim_point(stage: Stage) -> NDArray[np.float64]:
    """Return the tip of the arrow (3,) m: the goal of the box's hit point, or a way ahead."""
    wish = stage.wish
    return np.asarray(wish.position + AHEAD * wish.direction if wish.goal is None else wish.goal)


def grid_faces(rows: int, columns: int) -> NDArray[np.int64]:
    """Return the triangles of a grid of points, (2 (rows - 1) (columns - 1), 3)."""
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
    return np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, c, b), (b, c, d))])
