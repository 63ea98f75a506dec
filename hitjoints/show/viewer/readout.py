"""What the viewer says in numbers, as pieces of HTML that suit a light and a dark page."""

from __future__ import annotations

from html import escape
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.dynamics.inertia import inertia_along
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError
from hitjoints.quantities import hitting_speed
from hitjoints.show.style import colour_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from hitjoints.show.viewer.stage import Stage

RED = "light-dark(#c92a2a, #ff8787)"
GREEN = "light-dark(#2b7a3d, #8ce99a)"
LINE = "light-dark(#d0d5dd, #495057)"
ROWS = (
    ("inertia", "kg", "inertia"),
    ("deliverable flux", "m/s", "deliverable_flux"),
    ("straight flux", "m/s", "straight_flux"),
    ("flux", "m/s", "flux"),
    ("straight speed", "m/s", "straight_speed"),
    ("speed", "m/s", "speed"),
)
"""What is said of a candidate: words, unit, and its name in `Candidate`."""


def candidates(stage: Stage) -> str:
    """Return all joints' candidates side by side, and why the others are none."""
    if stage.plan is None:
        return _paragraph("Nothing is planned yet: press <b>plan</b>, or drag the object.")
    if not stage.is_planned:
        return _paragraph(_coloured("The plan is for another hit: press <b>plan</b>.", RED))
    told = stage.candidates
    heads = [_joint(one.joint, chosen=one.joint == stage.contact.joint) for one in told]
    rows = []
    for words, unit, name in ROWS:
        values = [getattr(one, name) for one in told]
        if any(value is not None for value in values):
            cells = ["–" if value is None else f"{value:.3g}" for value in values]
            rows.append((f"{words} <small>{unit}</small>", *cells))
    able = stage.plan.best
    verdicts = [
        _coloured("best", GREEN) if able is not None and one.joint == able.joint
        else "can" if one.feasible else _coloured("no", RED)
        for one in told
    ]  # fmt: skip
    reasons = [f"joint {one.joint}: {escape(one.reason)}" for one in told if not one.feasible]
    best = f"planned for {escape(stage.wish.setting.objective)}"
    text = _table(("", *heads), [("", *verdicts), *rows])
    return text + _paragraph("<br>".join([best, *reasons]), small=True)


def here(stage: Stage) -> str:
    """Return the quantities of a hit from the configuration shown."""
    robot, q, contact, hit = stage.robot, stage.q, stage.contact, stage.wish
    at = position(robot, q, contact)
    rows = [
        ("contact", ", ".join(f"{v:.3f}" for v in at), "m"),
        ("from the object", f"{np.linalg.norm(hit.position - at):.3f}", "m"),
    ]
    try:
        inertia = inertia_along(robot, q, contact, hit.direction)
    except InfeasibleError as error:
        rows.append(("inertia", escape(error.reason), ""))
        return _table(("here", "", ""), rows)
    rows.append(("inertia", f"{inertia:.3f}", "kg"))
    for name, straight in (("", False), (", straight", True)):
        speed = hitting_speed(robot, q, contact, hit.direction, straight=straight)
        rows.append((f"greatest speed{name}", f"{speed:.3f}", "m/s"))
        rows.append((f"greatest flux{name}", f"{hit.flux_of(inertia, speed):.3f}", "m/s"))
    return _table((f"joint {contact.joint}, here", "", ""), rows)


def joints(stage: Stage) -> str:
    """Return where each joint is, and what a motion takes of its limits; red at them."""
    robot, shares = stage.robot, stage.shares
    rows = []
    for i, red in enumerate(stage.at_limit):
        ends = [_angle(robot.lower[i]), _angle(stage.q[i]), _angle(robot.upper[i])]
        ends += [f"{100 * share[i]:.0f} %" for share in shares.values()]
        rows.append((f"q{i + 1}", *(_coloured(cell, RED) if red else cell for cell in ends)))
    return _table(("", "least", "q (rad)", "most", *shares), rows)


def motion(stage: Stage) -> str:
    """Return what is played, whether it can be sent, and where the box comes to rest."""
    clip, said = stage.clip, []
    if clip is not None:
        lines = [f"<b>{escape(clip.kind)}</b> of {clip.duration:.2f} s"]
        if clip.impact_time is not None and clip.speed is not None:
            lines.append(f"hits after {clip.impact_time:.3f} s with {clip.speed:.3f} m/s")
        can = _coloured("can be sent", GREEN)
        lines.append(_coloured(escape(clip.why), RED) if clip.why else can)
        if clip.note:
            lines.append(_coloured(escape(clip.note), RED))
        said.append(_paragraph("; ".join(lines)))
    if stage.candidate is not None or clip is not None:
        said.append(_paragraph(rest(stage), small=True))
    return "".join(said)


def rest(stage: Stage) -> str:
    """Return where the box comes to rest, and what is assumed for it."""
    found, why = stage.rest
    if found is None:
        return f"The box's way is not known: {escape(why)}"
    at = ", ".join(f"{v:.3f}" for v in found.mean[:2])
    sides = 100 * np.sqrt(np.linalg.eigvalsh(found.covariance).clip(0))
    text = f"The box comes to rest at ({at}) m, ± {sides[1]:.1f} and {sides[0]:.1f} cm"
    if stage.wish.goal is not None:
        near = f"{100 * found.within:.0f} of 100 within {found.tolerance:g} m of the goal"
        text += f"; {near}"
    words = stage.assumption.words
    return text + (f" <i>(assumed: {escape(words)})</i>" if words else "")


def note(surface: str) -> str:
    """Return what the blue surface is."""
    return _paragraph(f"Blue surface: {escape(surface)}.", small=True) if surface else ""


def _joint(number: int, *, chosen: bool) -> str:
    mark = f'<span style="color:{colour_of(number)}">●</span>'
    words = f"<b><u>joint&nbsp;{number}</u></b>" if chosen else f"joint&nbsp;{number}"
    return f"{mark}&nbsp;{words}"


def _angle(value: float) -> str:
    return f"{value:.3f}" if np.isfinite(value) else "–"


def _coloured(text: str, colour: str) -> str:
    return f'<span style="color:{colour};font-weight:600">{text}</span>'


def _paragraph(text: str, *, small: bool = False) -> str:
    size = "0.78em" if small else "0.85em"
    return f'<p style="margin:0.3em 0.75em;font-size:{size};line-height:1.35">{text}</p>'


def _table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table whose first column is words and whose others are numbers."""
    line = f"border-bottom:1px solid {LINE}"

    def cells(tag: str, row: Sequence[str]) -> str:
        sides = ["left", *["right"] * (len(row) - 1)]
        style = f"padding:0.12em 0.3em;font-weight:inherit;{line}"
        return "".join(
            f'<{tag} style="text-align:{side};{style}">{cell}</{tag}>'
            for side, cell in zip(sides, row, strict=True)
        )

    body = "".join(f"<tr>{cells('td', row)}</tr>" for row in rows)
    return (
        '<div style="overflow-x:auto;margin:0.2em 0.75em">'
        '<table style="width:100%;border-collapse:collapse;'
        'font-size:0.82em;font-variant-numeric:tabular-nums">'
        f"<thead><tr>{cells('th', heads)}</tr></thead><tbody>{body}</tbody></table></div>"
    )
