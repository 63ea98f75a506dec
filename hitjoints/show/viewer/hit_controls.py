"""The controls of what is wanted: the joint, the object, where to and how hard."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.planning.objectives.registry import OBJECTIVES

if TYPE_CHECKING:
    from collections.abc import Callable

    from hitjoints.show.viewer.panel import Pressed
    from hitjoints.show.viewer.stage import Stage

BEST = "best"
WAYS = ("direction", "goal")
REACH = 0.3  # m, to a goal that was a direction before


class HitControls:
    """Builds them and keeps them as the stage is.

    Args:
        gui: viser's, in the tab they belong to.
        stage: that they change.
        do: what is done with a change.
        heard: makes a callback that is deaf to what is set here.
    """

    def __init__(
        self,
        gui: Any,
        stage: Stage,
        do: Pressed,
        heard: Callable[[Callable[[], None]], Callable[[object], None]],
    ) -> None:
        self._stage, wish = stage, stage.wish
        self._source: Any = None
        joints = (BEST, *(str(k) for k in range(1, stage.robot.n + 1)))
        self.joint = gui.add_dropdown("hit with", joints, initial_value=str(stage.contact.joint))
        self.objective = gui.add_dropdown("objective", tuple(OBJECTIVES))
        self.position = gui.add_vector3("object (m)", _three(wish.position), step=0.001)
        self.way = gui.add_dropdown("aim by", WAYS)
        self.direction = gui.add_vector3("direction", _three(wish.direction), step=0.001)
        self.goal = gui.add_vector2("goal (m)", (0.0, 0.0), step=0.001)
        self.flux = gui.add_number(
            "flux (m/s)", 0.0, min=0.0, step=0.01, hint="0: as much as there can be"
        )
        self.mass = gui.add_number("mass (kg)", float(wish.mass), min=1e-6, step=0.001)
        filled = stage.assumption.hit
        self.restitution = gui.add_slider(
            "restitution", 0.0, 1.0, 0.01, float(filled.restitution or 0.0)
        )
        self.friction = gui.add_slider("friction", 0.01, 1.5, 0.01, float(filled.friction or 0.01))
        self.by_itself = gui.add_checkbox("plan at each change", True)
        for label, work in {
            "plan": do.ask_plan,
            "place the joint at the object": lambda: do.glance(stage.place),
            "home": lambda: do.glance(lambda: stage.turn(stage.robot.home)),
        }.items():
            gui.add_button(label).on_click(lambda _, work=work: work())
        changes: tuple[tuple[Any, Callable[[], None]], ...] = (
            (self.objective, lambda: stage.choose_objective(self.objective.value)),
            (self.position, lambda: stage.move_object(self.position.value)),
            (self.way, self._aim),
            (self.direction, lambda: stage.aim_along(self.direction.value)),
            (self.goal, lambda: stage.aim_at(self.goal.value)),
            (self.flux, lambda: stage.change(flux=self.flux.value or None, object_speed=None)),
            (self.mass, lambda: stage.change(mass=self.mass.value)),
            (self.restitution, lambda: stage.slide_with(restitution=self.restitution.value)),
            (self.friction, lambda: stage.slide_with(friction=self.friction.value)),
        )
        # To look at another joint is not to ask for a plan.
        self.joint.on_update(heard(lambda: do.change(self._choose, plans=stage.plan is not None)))
        for control, change in changes:
            control.on_update(heard(partial(do.change, partial(self._change, control, change))))

    def _change(self, control: Any, change: Callable[[], None]) -> None:
        self._source = control
        change()

    def _choose(self) -> None:
        said = self.joint.value
        self._stage.choose(None if said == BEST else int(said))

    def _aim(self) -> None:
        wish = self._stage.wish
        if self.way.value == "direction":
            self._stage.aim_along(wish.direction)
            return
        level = wish.direction[:2]
        length = float(np.hypot(*level))
        way = level / length if length > 0 else np.array((1.0, 0.0))
        self._stage.aim_at(wish.position[:2] + REACH * way)

    def refresh(self) -> None:
        """Show what the stage says."""
        stage, wish = self._stage, self._stage.wish
        at_goal, filled = wish.goal is not None, stage.assumption.hit
        self.direction.visible = self.flux.visible = not at_goal
        self.goal.visible = at_goal
        goal = wish.position if wish.goal is None else wish.goal
        for control, value in (
            (self.joint, BEST if stage.follows_best else str(stage.contact.joint)),
            (self.objective, wish.setting.objective),
            (self.position, _three(wish.position)),
            (self.way, "goal" if at_goal else "direction"),
            (self.direction, _three(wish.direction)),
            (self.goal, _three(goal)[:2]),
            (self.flux, float(wish.flux or 0.0)),
            (self.mass, float(wish.mass)),
            (self.restitution, float(filled.restitution or 0.0)),
            (self.friction, float(filled.friction or 0.0)),
        ):
            if control is not self._source:  # there the browser may be ahead: it is being typed in
                control.value = value
        self._source = None


def _three(values: Any) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in values)
    return x, y, z
