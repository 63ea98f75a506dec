"""A page of the scene that needs no server and no network: it plays the motion by itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from hitjoints.show.viewer import readout

if TYPE_CHECKING:
    from hitjoints.show.viewer.drawing import Drawing
    from hitjoints.show.viewer.stage import Stage

RATE = 30  # pictures per second of the page
PICTURES = 400  # at most; a long motion has fewer per second
THEME = "window.__VISER_EMBED_CONFIG__={darkMode:false}"
CHOSEN = (
    "window.__VISER_EMBED_CONFIG__={darkMode:matchMedia('(prefers-color-scheme: dark)').matches}"
)
SHEET = """
<style>
:root { color-scheme: light dark; }
#hitjoints { position: fixed; top: 0.6em; left: 0.6em; z-index: 5;
  width: min(24em, calc(100vw - 1.2em));
  max-height: 55vh; overflow: auto;
  box-sizing: border-box; padding: 0.5em 0.8em; border-radius: 6px;
  font: 15px/1.35 system-ui, sans-serif; color: light-dark(#1f2933, #e9ecef);
  background: light-dark(rgb(255 255 255 / 0.92), rgb(26 27 30 / 0.92));
  box-shadow: 0 1px 6px rgb(0 0 0 / 0.25); }
#hitjoints summary { cursor: pointer; font-weight: 600; }
@media (max-width: 640px) { #hitjoints { font-size: 13px; max-height: 40vh; } }
</style>
"""
OPEN_WHERE_WIDE = "<script>document.getElementById('hitjoints').open = innerWidth > 640;</script>"


def recorded_page(server: Any, drawing: Drawing, speed: float) -> str:
    """Return the scene of a server as a page.

    Args:
        server: viser's, whose scene shows a stage.
        drawing: of the scene; its stage is left at the end of the motion.
        speed: of playing, in the page's usual speed.
    """
    stage = drawing.stage
    stage.seek(0.0)
    drawing.wish()
    serializer = server.get_scene_serializer()
    if stage.clip is not None:
        length = stage.clip.duration / speed
        count = min(PICTURES, max(2, math.ceil(RATE * length)))
        for number in range(1, count + 1):
            serializer.insert_sleep(length / count)
            stage.seek(stage.clip.duration * number / count)
            drawing.moment()
    page = str(serializer.as_html())
    head, body, rest = page.replace(THEME, CHOSEN, 1).partition("<body>")
    stage.seek(0.0)
    return head + SHEET + body + _words(stage, drawing.scale, speed) + rest


def _words(stage: Stage, scale: str, speed: float) -> str:
    """Return what the panel of a live viewer would say at first."""
    slow = "" if stage.clip is None else f", played at {speed:g} × its speed"
    title = f"{stage.robot.title or stage.robot.name}: joint {stage.contact.joint} hits"
    parts = [
        f"<summary>{title} {stage.wish.words}{slow}</summary>",
        readout.candidates(stage) if stage.plan is not None else "",
        readout.motion(stage),
        readout.here(stage),
        readout.note(scale),
    ]
    return f'<details id="hitjoints" open>{"".join(parts)}</details>{OPEN_WHERE_WIDE}'
