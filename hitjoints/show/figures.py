"""Every figure of the project, by what it shows: `hj.figures`.

Each function returns a matplotlib figure, which a notebook shows and `save` writes. How it looks
is the same everywhere: `size` ("single" or "double" column, "WIDTHxHEIGHT" or (width, height) in
mm), `font`, `style` (a `.mplstyle`), else the matplotlibrc. With `ax` only the main panel is drawn,
on that axis, which keeps its own look.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Unpack

from hitjoints.errors import InputError
from hitjoints.show.style import Look, LookOptions

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from numpy.typing import ArrayLike
    from xarray import Dataset

    from hitjoints.answers.answer_record import Answer
    from hitjoints.evidence.calibration.past_hits import Calibration
    from hitjoints.evidence.paper.reproduction import Reproduction
    from hitjoints.evidence.physics.simulated_hit import Simulation
    from hitjoints.evidence.recordings.replayer import Replay
    from hitjoints.model.robot import Contact, Robot
    from hitjoints.planning.plan_record import Plan
    from hitjoints.rollouts.record import Rollout
    from hitjoints.show.sheet import Sheet
    from hitjoints.swings.swing_record import Swing

__all__ = [
    "answer", "arm", "calibration", "contact_time_sweep", "joint_sweep", "mass_sweep", "plan",
    "replay", "reproduction", "rollout", "save", "simulation", "swing", "winning_joint",
    "workspace",
]  # fmt: skip


def save(figure: Figure, path: str | Path) -> None:
    """Save a figure as .png, .pdf (fonts of Type 42) or .svg (text stays text).

    Raises:
        InputError: another ending, or a path that cannot be written.
    """
    from hitjoints.show.sheet import save_figure

    save_figure(figure, Path(path), "path")


def arm(
    robot: Robot,
    q: ArrayLike,
    contact: Contact | int | None = None,
    direction: ArrayLike | None = None,
    object_size: ArrayLike | None = None,
    *,
    ellipsoid: bool = True,
    ax: Axes | None = None,
    **look: Unpack[LookOptions],
) -> Figure:
    """Draw an arm by its collision shapes, with what it hits.

    Args:
        robot: the arm.
        q: (n,) rad.
        contact: joint number or Contact that hits; none draws the arm alone.
        direction: (3,), the hitting direction.
        object_size: (3,) m, edges of a box, its near face at the surface of the link that hits.
        ellipsoid: draw the directional inertia at the contact: the distance from there along
            any direction is 1 / (u^T J M^-1 J^T u), to a scale in the legend.
        ax: where to draw; by default a figure of its own.
        look: size, font and style, see above.

    Raises:
        InputError: an argument cannot be used.
    """
    from hitjoints.show.arm_figure import draw_arm

    def main(axis: Axes) -> None:
        draw_arm(axis, robot, q, contact, direction, object_size, ellipsoid=ellipsoid)

    return _drawn(_alone(main, (5.0, 4.4)), main, ax, look)


def plan(
    result: Plan,
    robot: Robot | None = None,
    ax: Axes | None = None,
    **look: Unpack[LookOptions],
) -> Figure:
    """Draw a plan: the arm at the hit, and the objective of every joint (main panel).

    Args:
        result: a plan.
        robot: the arm; by default as the plan says how to load it. Without one it is not drawn.
        ax: where to draw the main panel.
        look: size, font and style, see above.
    """
    from hitjoints.show.plan_figure import draw_objective, draw_plan

    if robot is None and ax is None and result.hit.setting.robot is not None:
        robot = result.load_robot()
    return _drawn(
        lambda how: draw_plan(result, robot, how), lambda axis: draw_objective(axis, result),
        ax, look, result.hit.text,
    )  # fmt: skip


def swing(result: Swing, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw a swing: shares of all limits along time (velocity is the main panel), and its way."""
    from hitjoints.show.swing_figure import draw_swing, draw_velocity

    return _drawn(
        lambda how: draw_swing(result, how), lambda axis: draw_velocity(axis, result),
        ax, look, result.hit.text,
    )  # fmt: skip


def rollout(result: Rollout, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw a rollout: inertia (main panel), speed and flux, distance from the line, limits."""
    from hitjoints.show.rollout_figure import draw_inertia, draw_rollout

    return _drawn(
        lambda how: draw_rollout(result, how), lambda axis: draw_inertia(axis, result),
        ax, look, result.parameters.get("hit", ""),
    )  # fmt: skip


def simulation(result: Simulation, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw a simulated hit: speeds through the contact (main panel), errors, the box's way."""
    from hitjoints.show.simulation_figure import draw_contact, draw_simulation

    return _drawn(
        lambda how: draw_simulation(result, how), lambda axis: draw_contact(axis, result),
        ax, look, result.motion.parameters.get("hit", ""),
    )  # fmt: skip


def replay(result: Replay, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw recorded hits: their speeds, and predicted against measured ones (main panel)."""
    from hitjoints.show.replay_figure import draw_predicted, draw_replay

    return _drawn(
        lambda how: draw_replay(result, how), lambda axis: draw_predicted(axis, result), ax, look
    )


def calibration(result: Calibration, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw a calibration: landings against what the others foresee (main panel), and residuals."""
    from hitjoints.show.calibration_figure import draw_calibration, draw_foreseen

    return _drawn(
        lambda how: draw_calibration(result, how), lambda axis: draw_foreseen(axis, result),
        ax, look,
    )  # fmt: skip


def answer(result: Answer, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw an answer: the arm at the hit, the way from above (main panel), limits used.

    An answer without a swing is drawn as its plan.
    """
    from hitjoints.show.answer_figure import draw_answer, draw_way
    from hitjoints.show.plan_figure import draw_objective

    def main(axis: Axes) -> None:
        if result.swing is None:
            draw_objective(axis, result.plan)
        else:
            draw_way(axis, result.swing, result.landing)

    return _drawn(lambda how: draw_answer(result, how), main, ax, look, result.hit.text)


def joint_sweep(swept: Dataset, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw a data set of `sweep_joint`: inertia, speed and flux (main panel) by joint angle."""
    from hitjoints.show.joint_sweep_figure import draw_joint_sweep, draw_over_angle

    return _drawn(
        lambda how: draw_joint_sweep(swept, how),
        lambda axis: draw_over_angle(axis, swept, "flux"), ax, look, swept.attrs.get("hit", ""),
    )  # fmt: skip


def mass_sweep(swept: Dataset, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw a data set of `sweep_mass`: flux by the object's mass."""
    from hitjoints.show.mass_sweep_figure import draw_mass_sweep, draw_over_mass

    return _drawn(
        lambda how: draw_mass_sweep(swept, how), lambda axis: draw_over_mass(axis, swept), ax, look
    )


def contact_time_sweep(
    swept: Dataset, ax: Axes | None = None, **look: Unpack[LookOptions]
) -> Figure:
    """Draw a data set of `sweep_contact_time`: inertia shown (main panel), and object speed."""
    from hitjoints.show.contact_time_figure import (
        draw_contact_time_sweep,
        draw_over_contact_time,
    )

    return _drawn(
        lambda how: draw_contact_time_sweep(swept, how),
        lambda axis: draw_over_contact_time(axis, swept, "equivalent"),
        ax, look, swept.attrs.get("hit", ""),
    )  # fmt: skip


def winning_joint(found: Dataset, ax: Axes | None = None, **look: Unpack[LookOptions]) -> Figure:
    """Draw which joint shows most inertia where, for each contact time (main panel: the last)."""
    from hitjoints.show.winning_joint_figure import draw_winning_joint, draw_winning_joint_at

    return _drawn(
        lambda how: draw_winning_joint(found, how),
        lambda axis: draw_winning_joint_at(axis, found, float(found.time.values[-1])), ax, look,
    )  # fmt: skip


def workspace(
    robot: Robot,
    swept: Dataset,
    direction: int = 0,
    ax: Axes | None = None,
    **look: Unpack[LookOptions],
) -> Figure:
    """Draw a map of `sweep_workspace`: inertia and flux of each joint, the best (main panel).

    Args:
        robot: the arm.
        swept: the map.
        direction: which of its directions, from 0.
        ax: where to draw the main panel.
        look: size, font and style, see above.

    Raises:
        InputError: the map is no plane: fewer than two axes have two coordinates or more.
    """
    from hitjoints.show.workspace_figure import draw_best, draw_workspace

    return _drawn(
        lambda how: draw_workspace(robot, swept, how, direction),
        lambda axis: draw_best(axis, swept, "flux", direction), ax, look,
    )  # fmt: skip


def reproduction(result: Reproduction, **look: Unpack[LookOptions]) -> dict[str, Figure]:
    """Draw the paper's figures of what was run, by name: fig2, fig4, fig5, fig6, spread."""
    from hitjoints.show.paper_figures import draw_reproduction

    how = Look(**look)
    with how.applied():
        drawn = draw_reproduction(result, how)
        for figure in drawn.values():
            figure.fit()
    return dict(drawn)


def _drawn(
    whole: Callable[[Look], Sheet],
    main: Callable[[Axes], None],
    ax: Axes | None,
    options: LookOptions,
    hit: str = "",
) -> Figure:
    """Return the whole figure, which keeps the hit, or that of `ax` with the main panel on it.

    Raises:
        InputError: a look for an axis that has one.
    """
    given = [name for name, value in options.items() if value is not None]
    if ax is not None:
        if given:
            raise InputError(given[0], options[given[0]], "an axis given as ax has its own look")  # type: ignore[literal-required]
        main(ax)
        drawn: Figure = ax.figure.figure  # of a part of a figure, the whole
        return drawn
    look = Look(**options)
    with look.applied():
        figure = whole(look)
        figure.hit = hit
        figure.fit()
    return figure


def _alone(main: Callable[[Axes], None], panel: tuple[float, float]) -> Callable[[Look], Sheet]:
    from hitjoints.show.sheet import sheet

    def draw(look: Look) -> Sheet:
        figure, (axis,) = sheet(look, 1, 1, panel)
        main(axis)
        return figure

    return draw
