"""Draw a plan: the arm at the chosen configuration, and what was wanted of every joint."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.model.robot import Contact
from hitjoints.show.drawn_arm import BoxAt, add_ground, arm_picture, chain
from hitjoints.show.sheet import Sheet, below, sheet, wrapped
from hitjoints.show.style import Look, colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from hitjoints.model.robot import Robot
    from hitjoints.planning.candidates import Candidate
    from hitjoints.planning.plan_record import Plan

OBJECT = (0.12, 0.12, 0.12)
"""m, edges of the box drawn for an object of unknown size."""
WANTED: dict[str, tuple[str, str, str | None, str]] = {
    "inertia": ("inertia", r"directional inertia $\lambda_h$ (kg)", None, ""),
    "rebound": ("inertia", r"directional inertia $\lambda_h$ (kg)", None, ""),
    "flux": ("flux", r"maximum flux $\phi_{\max}$ (m/s)", "straight_flux", "straight along $h$"),
    "straight-flux": ("straight_flux", r"straight flux (m/s)", None, ""),
    "deliverable": ("deliverable_flux", r"deliverable flux (m/s)", None, ""),
}
"""Of each objective: the attribute, its label, and what is drawn inside it with its name."""


def draw_plan(plan: Plan, robot: Robot | None, look: Look) -> Sheet:
    """Return the figure of a plan: the arm with the object, and the objective of every joint.

    Args:
        plan: with or without a best joint.
        robot: the arm; None leaves out its picture, as does a plan that says no.
        look: how it is to look.
    """
    shown = robot is not None and plan.best is not None
    figure, axes = sheet(look, 2 if shown else 1, 2, (5.0, 4.2))
    if robot is not None and plan.best is not None:
        _draw_scene(axes[0], robot, plan, plan.best, figure)
    draw_objective(axes[-1], plan)
    at = ", ".join(f"{value:g}" for value in plan.position)
    along = ", ".join(f"{value:.3g}" for value in plan.direction)
    figure.headline(
        f"{plan.robot}: object of {plan.mass:g} kg at ({at}) m, hit along ({along}); "
        f"planned for {plan.objective}"
    )
    return figure


def _draw_scene(axis: Axes, robot: Robot, plan: Plan, best: Candidate, figure: Sheet) -> None:
    contact, hit = robot.contact(Contact(best.joint, best.offset)), plan.hit
    size, yaw = (hit.setting.object_size, None) if hit.size is None else (hit.size, hit.yaw)
    size = OBJECT if size is None else size
    box = BoxAt.touched(robot, best.q, contact, plan.direction, size, yaw)
    picture, handles = arm_picture(robot, best.q, contact, plan.direction, box=box)
    grid = add_ground(picture, np.vstack([chain(robot, best.q), box.corners]))
    picture.draw(axis)
    axis.set_title(f"joint {best.joint}: {best.inertia:.3g} kg, {best.speed:.3g} m/s; {grid}")
    below(axis, 0.5, 2, handles=handles)


def draw_objective(axis: Axes, plan: Plan) -> None:
    """Draw what was wanted of each joint as bars, the winner's outlined."""
    name, label, inner, inner_label = WANTED[plan.objective]
    width = axis.get_window_extent().width / axis.figure.dpi / len(plan.candidates)  # in
    for place, one in enumerate(plan.candidates):
        value = getattr(one, name)
        if not one.feasible or value is None or not np.isfinite(value):
            reason = "not known" if one.feasible else one.reason.partition(":")[0]
            words = wrapped(reason, width, 0.83)
            axis.text(place, 0, words, ha="center", va="bottom", color="dimgrey", fontsize="small")
            continue
        best, colour = one is plan.best, colour_of(one.joint)
        axis.bar(
            place, value, width=0.7, color=colour, alpha=0.9 if inner is None else 0.4,
            edgecolor="black" if best else "none", linewidth=1.5 if best else 0,
        )  # fmt: skip
        if inner is not None:
            axis.bar(place, getattr(one, inner), width=0.4, color=colour)
        axis.text(place, value, _words(one, name, best), ha="center", va="bottom", fontsize="small")
    if inner is not None:
        axis.bar(0, 0, color="grey", alpha=0.4, label="any motion")
        axis.bar(0, 0, color="grey", label=inner_label)
        below(axis, 2, 2)
    axis.set_xticks(range(len(plan.candidates)), [f"joint {c.joint}" for c in plan.candidates])
    axis.set(ylabel=label, xlim=(-0.6, len(plan.candidates) - 0.4))
    axis.margins(y=0.15)


def _words(one: Any, name: str, best: bool) -> str:
    """Return what stands over a joint's bar: the number, and the other of inertia and flux."""
    other = f"{one.flux:.3g} m/s" if name == "inertia" else f"{one.inertia:.3g} kg"
    unit = "kg" if name == "inertia" else "m/s"
    return f"{'best: ' if best else ''}{getattr(one, name):.3g} {unit}\n({other})"
