"""An arm in the browser: turn its joints and see what it would hit with, and how hard."""

from __future__ import annotations

import io
import signal
import threading
import time
from contextlib import redirect_stdout
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from hitjoints.dynamics.inertia import inertia_along, inverse_inertia
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import HitjointsError, InfeasibleError, InputError, MissingExtraError
from hitjoints.hit import Hit
from hitjoints.model.robot import Contact
from hitjoints.planning.planner import plan
from hitjoints.quantities import hitting_speed
from hitjoints.rollouts.follow import rollout
from hitjoints.rollouts.prepare import placed
from hitjoints.show.drawn_arm import ARROW, BOX, INERTIA, LINK, rgb
from hitjoints.show.inertia_surface import inertia_surface
from hitjoints.show.origin import own_pages_only
from hitjoints.show.solids import solids
from hitjoints.show.style import colour_of
from hitjoints.swings.make_swing import swing

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.robot import Robot
    from hitjoints.show.solids import Solid
    from hitjoints.types import Array

FRAMES = 30.0  # per s
SLOWER = 10  # a hit takes a tenth of a second: it is played so many times slower
STEP = 0.001  # rad, of the sliders
EDGE, POINT = 0.1, 0.018  # m, of the object drawn, and radius of the contact
ENDS = (signal.SIGINT, signal.SIGTERM)
GLASS = 0.7  # opacity of the links: a joint's origin lies inside its link


class Viewer:
    """Serves an arm to browsers; made by `view`.

    Attributes:
        robot: the arm.
        url: where it is served.
        q: (n,) rad, the configuration shown.
    """

    def __init__(self, robot: Robot, hit: Hit, q: Array, host: str, port: int) -> None:
        try:
            import viser
        except ImportError:
            raise MissingExtraError("viser", "view") from None
        self.robot, self.q = robot, q
        self._offset = robot.contact(hit.chosen_contact).offset
        self._planned: tuple[Hit, Array] | None = None
        self._lock, self._moving = threading.RLock(), False
        shapes = solids(robot)
        self._carriers = [(one.joint, one.placement) for one in shapes]
        with _silence(), own_pages_only(host):
            self._server = viser.ViserServer(host, port, verbose=False)
        self.url = f"http://{host}:{self._server.get_port()}"
        try:
            self._build_scene(shapes)
            self._build_panel(hit)
            self.move(q)
        except BaseException:
            self.stop()
            raise

    def move(self, q: ArrayLike) -> None:
        """Show another configuration.

        Args:
            q: (n,) rad, within the limits.

        Raises:
            InputError: it is not.
        """
        q = self.robot.within_limits(q)
        with self._lock, self._server.atomic():
            self.q, self._moving = q, True
            for slider, value in zip(self._sliders, _on_sliders(self.robot, q), strict=True):
                slider.value = value
            self._moving = False
            self._draw()

    def remember(self, hit: Hit, q: Array) -> None:
        """Play a hit to this configuration (n,) rad, as long as the panel says this hit."""
        self._planned = hit, q

    def as_html(self) -> str:
        """Return a page that shows what is shown now, without a server and the panel."""
        return str(self._server.scene.as_html())

    def serve(self, ready: Callable[[str], None] | None = None) -> None:
        """Serve until a signal asks to end: SIGINT, as by Ctrl-C, or SIGTERM.

        A shell starts what runs in the background with SIGINT ignored; here it counts even then.

        Args:
            ready: called with the URL when signals are waited for.
        """
        over = threading.Event()
        main = threading.current_thread() is threading.main_thread()
        before = {one: signal.signal(one, lambda *_: over.set()) for one in ENDS if main}
        try:
            if ready is not None:
                ready(self.url)
            over.wait()
        finally:
            for one, handler in before.items():
                signal.signal(one, handler)

    def stop(self) -> None:
        """Stop serving."""
        with _silence():
            self._server.stop()

    def _build_scene(self, shapes: list[Solid]) -> None:
        scene = self._server.scene
        scene.set_up_direction("+z")
        scene.add_grid("/floor", 2.0, 2.0, cell_size=0.1, section_size=0.5)
        self._server.initial_camera.position = (1.2, 0.75, 0.85)
        self._server.initial_camera.look_at = (0.15, 0.05, 0.4)
        self._links = [
            scene.add_mesh_simple(
                f"/arm/{one.name}", one.vertices, one.faces, color=rgb(LINK), opacity=GLASS
            )
            for one in shapes
        ]
        self._object = scene.add_box("/object", rgb(BOX), (EDGE, EDGE, EDGE))

    def _build_panel(self, hit: Hit) -> None:
        gui, robot = self._server.gui, self.robot
        self._numbers = gui.add_markdown("")
        with gui.add_folder("Hit"):
            joints = [str(k) for k in range(1, robot.n + 1)]
            number = str(robot.contact(hit.chosen_contact).joint)
            self._joint = gui.add_dropdown("joint", joints, initial_value=number)
            self._at = gui.add_vector3("object (m)", tuple(hit.position), step=0.01)
            self._along = gui.add_vector3("direction", tuple(hit.direction), step=0.05)
            self._mass = gui.add_number("mass (kg)", float(hit.mass), step=0.1)
            self._flux = gui.add_number("flux (m/s)", float(hit.desired_flux), step=0.01)
            works = {
                "place the joint at the object": self._place,
                "plan for inertia": self._plan,
                f"hit, {SLOWER:g} times slower": self._play,
                "swing from here": self._swing,
                "home": lambda: self.move(robot.home),
            }
            for label, work in works.items():
                gui.add_button(label).on_click(partial(self._try, work))
            self._answer = gui.add_markdown("")
        with gui.add_folder("Joints (rad)"):
            low, high = robot.finite_limits
            self._sliders: list[Any] = [
                # A locked joint's slider has an end that it never goes to.
                gui.add_slider(f"q{i + 1}", low[i], max(high[i], low[i] + STEP), STEP, value)
                for i, value in enumerate(_on_sliders(robot, self.q))
            ]
        for control in (self._joint, self._at, self._along, self._mass):
            control.on_update(lambda _: self._draw())
        for slider in self._sliders:
            slider.on_update(lambda _: self._turned())

    def _turned(self) -> None:
        with self._lock:
            if not self._moving:
                wanted = np.array([slider.value for slider in self._sliders])
                self.q = np.clip(wanted, self.robot.lower, self.robot.upper)
                self._draw()

    def _hit(self) -> Hit:
        """Return the hit that the panel says."""
        contact = Contact(int(self._joint.value), self._offset)
        along, at = np.array(self._along.value), np.array(self._at.value)
        return Hit(contact, at, along, self._mass.value, self._flux.value)

    def _try(self, work: Callable[[], None], _: object) -> None:
        """Do what a button says, and say why not when that is the answer."""
        self._answer.content = "..."
        try:
            work()
            self._answer.content = ""
        except HitjointsError as error:
            self._answer.content = f"**No:** {error}"

    def _place(self) -> None:
        hit = self._hit()
        self.move(placed(self.robot, self.robot.contact(hit.chosen_contact), hit.position, self.q))

    def _plan(self) -> None:
        hit = self._hit()
        found = plan(self.robot, hit.position, hit.direction, hit.mass, [hit.chosen_contact])
        if found.best is None or found.best.q is None:
            raise InfeasibleError(found.candidates[0].reason)
        self.remember(hit, found.best.q)
        self.move(found.best.q)

    def _play(self) -> None:
        hit, q_hit = self._hit(), self._planned_for(self._hit())
        result = rollout(self.robot, hit, q_hit=q_hit)
        self._show(result.rows["q"], SLOWER * result.dt)

    def _swing(self) -> None:
        hit = self._hit()
        made = swing(self.robot, hit, q0=self.q, q_hit=self._planned_for(hit))
        self._show(made.joints.q, made.dt)

    def _planned_for(self, hit: Hit) -> Array | None:
        """Return the planned configuration (n,) rad, if it is one for this hit."""
        planned = self._planned
        return planned[1] if planned is not None and _is_at(planned[0], hit) else None

    def _show(self, rows: Array, dt: float) -> None:
        """Show configurations (N, n), a row every dt s."""
        every = max(1, round(1.0 / (FRAMES * dt)))
        frame = every * dt
        for q in rows[::every]:
            began = time.monotonic()
            self.move(q)
            time.sleep(max(0.0, frame - (time.monotonic() - began)))

    def _draw(self) -> None:
        """Put everything where it is in the configuration shown."""
        with self._lock, self._server.atomic():
            robot, data = self.robot, self.robot.data
            pin.forwardKinematics(robot.model, data, self.q)
            for link, (joint, placement) in zip(self._links, self._carriers, strict=True):
                at = data.oMi[joint] * placement
                link.position, link.wxyz = (
                    at.translation,
                    pin.Quaternion(at.rotation).coeffs()[[3, 0, 1, 2]],
                )
            try:
                hit = self._hit()
            except InputError as error:
                self._numbers.content = f"**{error}**"
                return
            blue = self._draw_hit(hit)
            self._numbers.content = _numbers(robot, self.q, hit) + blue

    def _draw_hit(self, hit: Hit) -> str:
        """Draw contact, direction, object and inertia; say in Markdown what the inertia's is."""
        scene, contact = self._server.scene, self.robot.contact(hit.chosen_contact)
        here, h = position(self.robot, self.q, contact), hit.direction
        colour = rgb(colour_of(contact.joint))
        scene.add_icosphere("/contact", POINT, colour, position=here)
        arrow = np.array([[here, here + ARROW * h]])
        scene.add_arrows(
            "/direction", arrow, (0, 0, 0), shaft_radius=0.006, head_radius=0.016, head_length=0.05
        )
        self._object.position = hit.position + EDGE / 2 * h / np.abs(h).max()
        drawn = inertia_surface(inverse_inertia(self.robot, self.q, contact))
        if drawn is None:
            scene.remove_by_name("/inertia")
            return ""
        surface, label = drawn
        scene.add_mesh_simple(
            "/inertia",
            surface.reshape(-1, 3),
            _grid_faces(*surface.shape[:2]),
            color=rgb(INERTIA),
            opacity=0.35,
            side="double",
            cast_shadow=False,
            position=here,
        )
        return f"\n\nBlue surface: {label}."


def _is_at(planned: Hit, hit: Hit) -> bool:
    """Tell whether a planned hit is this one but for its flux."""
    same = np.array_equal(planned.position, hit.position) and planned.mass == hit.mass
    return (
        same
        and np.allclose(planned.direction, hit.direction, rtol=0, atol=1e-12)
        and planned.contact == hit.contact
    )


def _silence() -> redirect_stdout[io.StringIO]:
    """Keep stdout clean: viser writes there, told to be quiet or not."""
    return redirect_stdout(io.StringIO())


def _numbers(robot: Robot, q: Array, hit: Hit) -> str:
    """Return the quantities of a hit from q, as a table in Markdown."""
    contact, h = robot.contact(hit.chosen_contact), hit.direction
    here = position(robot, q, contact)
    rows = [("contact", ", ".join(f"{v:.3f}" for v in here), "m")]
    rows.append(("from the object", f"{np.linalg.norm(hit.position - here):.3f}", "m"))
    try:
        inertia = inertia_along(robot, q, contact, h)
    except InfeasibleError as error:
        rows.append(("inertia", error.reason, ""))
    else:
        rows.append(("inertia", f"{inertia:.3f}", "kg"))
        for name, straight in (("", False), (", straight", True)):
            speed = hitting_speed(robot, q, contact, h, straight=straight)
            rows.append((f"greatest speed{name}", f"{speed:.3f}", "m/s"))
            rows.append((f"greatest flux{name}", f"{hit.flux_of(inertia, speed):.3f}", "m/s"))
    lines = ["| here | | |", "| --- | --- | --- |"]
    return "\n".join(lines + [f"| {' | '.join(row)} |" for row in rows])


def _on_sliders(robot: Robot, q: Array) -> list[float]:
    """Return a configuration (n,) rad as sliders show it: continuous joints within one turn."""
    turned = np.remainder(q + np.pi, 2 * np.pi) - np.pi
    shown = np.where(np.isfinite(robot.lower) & np.isfinite(robot.upper), q, turned)
    return [float(value) for value in np.clip(shown, *robot.finite_limits)]


def _grid_faces(rows: int, columns: int) -> NDArray[np.int64]:
    """Return the triangles of a grid of points, (2 (rows - 1) (columns - 1), 3)."""
    corner = np.arange(rows * columns).reshape(rows, columns)
    a, b, c, d = corner[:-1, :-1], corner[:-1, 1:], corner[1:, :-1], corner[1:, 1:]
    return np.concatenate([np.stack(t, -1).reshape(-1, 3) for t in ((a, c, b), (b, c, d))])
