"""Draw a plan: the arm at the chosen configuration, and the flux of every joint."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hitjoints.show.figures import colour_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from hitjoints.model.robot import Robot
    from hitjoints.planning.plan_record import Plan

OBJECT = (0.12, 0.12, 0.12)  # m, edges of the box drawn for the object


def draw_plan(
    robot: Robot, plan: Plan, object_size: tuple[float, float, float] | None = None
) -> Figure:
    """Return the figure of a plan that has a best joint.

    On the left the arm with the object, the direction and the inertia ellipsoid at the contact; on
    the right the flux of every joint, with the straight one inside it.
    """
    from matplotlib.figure import Figure

    from hitjoints.show.drawn_arm import draw_arm

    assert plan.best is not None
    figure = Figure(figsize=(10, 5), layout="constrained")
    scene = figure.add_subplot(1, 2, 1, projection="3d")
    draw_arm(
        scene,
        robot,
        plan.best.q,
        plan.best.joint,
        plan.direction,
        object_size=object_size or OBJECT,
    )
    scene.set_title(
        f"joint {plan.best.joint}: {plan.best.inertia:.3g} kg, {plan.best.speed:.3g} m/s",
        fontsize="medium",
    )
    _draw_bars(figure.add_subplot(1, 2, 2), plan)
    at = ", ".join(f"{value:g}" for value in plan.position)
    along = ", ".join(f"{value:.3g}" for value in plan.direction)
    figure.suptitle(
        f"{robot.name}: object of {plan.mass:g} kg at ({at}) m, hit along ({along}); "
        f"planned for {plan.objective}",
        fontsize="medium",
    )
    return figure


def _draw_bars(axis: Axes, plan: Plan) -> None:
    for place, one in enumerate(plan.candidates):
        if not one.feasible or one.flux is None or one.straight_flux is None:
            reason = one.reason.partition(":")[0].replace(" ", "\n")
            axis.text(place, 0, reason, ha="center", va="bottom", color="dimgrey", fontsize="small")
            continue
        colour = colour_of(one.joint)
        axis.bar(place, one.flux, width=0.7, color=colour, alpha=0.35)
        axis.bar(place, one.straight_flux, width=0.4, color=colour)
        axis.text(place, one.flux, f"{one.inertia:.3g} kg", ha="center", va="bottom")
    axis.bar(0, 0, color="grey", alpha=0.35, label="any motion")
    axis.bar(0, 0, color="grey", label="straight along $h$")
    axis.legend(frameon=False, loc="best")
    axis.set_xticks(range(len(plan.candidates)), [f"joint {c.joint}" for c in plan.candidates])
    axis.set_ylabel(r"maximum flux $\phi_{\max}$ (m/s)")
    axis.margins(y=0.12)
    axis.set_xlim(-0.6, len(plan.candidates) - 0.4)
    axis.spines[["top", "right"]].set_visible(False)
