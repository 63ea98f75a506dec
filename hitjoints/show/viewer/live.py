"""The viewer: a server whose panel and scene show one stage, and change it."""

from __future__ import annotations

import copy
import threading
from html import escape
from typing import TYPE_CHECKING, TypeVar

from hitjoints.errors import HitjointsError, MissingExtraError
from hitjoints.show.viewer.drawing import Drawing
from hitjoints.show.viewer.handles import Handles
from hitjoints.show.viewer.making import planned
from hitjoints.show.viewer.origin import own_pages_only
from hitjoints.show.viewer.page import recorded_page
from hitjoints.show.viewer.panel import Panel
from hitjoints.show.viewer.serving import silence, until_told
from hitjoints.show.viewer.stage import Stage
from hitjoints.show.viewer.timeline import SPEEDS, Timeline
from hitjoints.show.viewer.viewpoint import WIDE, fit_phone, look
from hitjoints.show.viewer.worker import Worker

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike

    from hitjoints.model.robot import Robot
    from hitjoints.planning.plan_record import Plan
    from hitjoints.show.viewer.clip import Clip
    from hitjoints.types import Array

T = TypeVar("T")
TAKES = 5.0  # s, about as long as playing a motion takes at first


class Viewer:
    """Serves a stage to browsers; made by `view`.

    Attributes:
        stage: what is shown: the wish, the plan, the motion, the configuration.
        url: where it is served.
    """

    def __init__(self, stage: Stage, host: str, port: int) -> None:
        try:
            import viser
        except ImportError:
            raise MissingExtraError("viser", "view") from None
        self.stage = stage
        self._lock = threading.RLock()
        with silence(), own_pages_only(host):
            self._server = viser.ViserServer(host, port, verbose=False)
        self.url = f"http://{host}:{self._server.get_port()}"
        self._worker = Worker()
        self._timeline = Timeline(self._show_time, self._stopped)
        try:
            self._drawing = Drawing(self._server.scene, stage)
            self._panel = Panel(self._server.gui, stage, self)
            self._handles = Handles(self._server.scene, stage, self.change)
            self.dress()
            self._show_all()
            look(self._server.initial_camera, stage, WIDE)
            self._server.on_client_connect(lambda client: fit_phone(client.camera, stage))
        except BaseException:
            self.stop()
            raise

    @property
    def robot(self) -> Robot:
        """The arm."""
        return self.stage.robot

    @property
    def q(self) -> Array:
        """The configuration shown, (n,) rad."""
        return self.stage.q

    def move(self, q: ArrayLike) -> None:
        """Show another configuration.

        Args:
            q: (n,) rad, within the limits.

        Raises:
            InputError: it is not.
        """
        q = self.robot.within_limits(q)
        self.glance(lambda: self.stage.turn(q))

    def show(self, clip: Clip) -> None:
        """Have a motion to play, slow enough to be seen."""
        with self._lock:
            self.stage.show(clip)
            self._ready()

    def make(self, motion: str | None = None) -> None:
        """Make a motion to the configuration that was planned, and have it to play.

        Args:
            motion: "swing", "swing from here" or "rollout"; by default a swing where the drives'
                limits are known.

        Raises:
            InfeasibleError: nothing is planned, or there is no motion.
            InputError: the arm or the hit lacks what the motion needs.
        """
        usual = "rollout" if self.robot.acceleration is None else "swing"
        with self._lock:
            self.stage.make(motion or usual)
            self._ready()

    def as_html(self) -> str:
        """Return a page that shows this, and plays the motion if there is one, without a server."""
        self._timeline.pause()
        with self._lock:
            time = self.stage.time
            self._handles.show(False)
            look(self._server.initial_camera, self.stage, None)
            try:
                return recorded_page(self._server, self._drawing, self._timeline.speed)
            finally:
                self.stage.seek(time)
                look(self._server.initial_camera, self.stage, WIDE)
                self.dress()
                self._show_all()

    def wait(self, timeout: float = 60.0) -> bool:
        """Wait until all that was asked for is planned and made, or so many seconds at most.

        Returns:
            Whether it is so.
        """
        return self._worker.wait(timeout)

    def serve(self, ready: Callable[[str], None] | None = None) -> None:
        """Serve until a signal asks to end: SIGINT, as by Ctrl-C, or SIGTERM.

        A shell starts what runs in the background with SIGINT ignored; here it counts even then.

        Args:
            ready: called with the URL when signals are waited for.
        """
        until_told(lambda: None if ready is None else ready(self.url))

    def stop(self) -> None:
        """Stop serving."""
        self._timeline.stop()
        self._worker.stop()
        with silence():
            self._server.stop()

    def change(self, work: Callable[[], None], *, plans: bool = True) -> None:
        """Change what is wanted, and plan for it if that is wished and the panel says so."""
        self._pause()
        with self._lock:
            done = self._tried(work)
            if done and plans and self._panel.hit.by_itself.value and self.stage.needs_plan:
                self._worker.ask(self._plan)
            self._show_all()

    def glance(self, work: Callable[[], None]) -> None:
        """Change the configuration alone."""
        self._pause()
        with self._lock, self._server.atomic():
            self._tried(work)
            self._moment()

    def ask_plan(self) -> None:
        """Plan for what is wanted."""
        self._worker.ask(self._plan, pause=0.0)

    def play_or_pause(self) -> None:
        """Play the motion, made first where there is none, or pause."""
        if self._timeline.plays:
            self._pause()
        elif self.stage.clip is None:
            self._worker.ask(self._make_and_play, pause=0.0)
        else:
            self._timeline.play()
            self._playing(self._timeline.plays)

    def scrub(self, time: float) -> None:
        """Show a moment of the motion, s."""
        self._timeline.scrub(time)
        self._playing(False)

    def set_speed(self, speed: float) -> None:
        """Play so many times as fast as it is."""
        self._timeline.speed = speed

    def dress(self) -> None:
        """Show the scene as the panel's View tab says."""
        self._server.gui.configure_theme(
            dark_mode=self._panel.dark.value, show_logo=False, show_share_button=False
        )
        self._handles.show(self._panel.arrows.value)

    def _plan(self) -> None:
        def work(stage: Stage) -> Plan:
            return planned(stage.robot, stage.wish, stage.contacts)

        def adopt(made: Plan) -> None:
            self._pause()
            self.stage.adopt(made)

        self._work("planning", work, adopt)

    def _make_and_play(self) -> None:
        motion = self._panel.motion.value

        def work(stage: Stage) -> Clip:
            stage.make(motion)
            assert stage.clip is not None
            return stage.clip

        def play(clip: Clip) -> None:
            self.show(clip)
            self._timeline.play()
            self._playing(True)

        self._work("making the motion", work, play)

    def _work(self, words: str, work: Callable[[Stage], T], keep: Callable[[T], None]) -> None:
        """Do long work with a copy of the stage, and keep what comes of it if it is still wanted.

        Args:
            words: what is done.
            work: given the copy.
            keep: given the result, with the lock held.
        """
        with self._lock:
            trial = copy.copy(self.stage)
            self._panel.say(words, busy=True)
        try:
            found, why = work(trial), ""
        except HitjointsError as error:
            found, why = None, str(error)
        with self._lock:
            self._panel.say(escape(why), no=True)
            if self.stage.wish is trial.wish or trial.wish == self.stage.wish:
                if found is not None:
                    keep(found)
                self._show_all()

    def _tried(self, work: Callable[[], None]) -> bool:
        """Do what a control says, and say why not when that is the answer."""
        try:
            work()
        except HitjointsError as error:
            self._panel.say(escape(str(error)), no=True)
            return False
        self._panel.say("")
        return True

    def _show_time(self, time: float) -> None:
        with self._lock, self._server.atomic():
            self.stage.seek(time)
            self._moment()

    def _pause(self) -> None:
        if self._timeline.plays:
            self._timeline.pause()
            self._playing(False)

    def _stopped(self) -> None:
        self._playing(False)

    def _playing(self, plays: bool) -> None:
        """Show whether it plays; what is dragged would stand in the way of what moves."""
        self._panel.playing(plays)
        self._handles.show(self._panel.arrows.value and not plays)

    def _show_all(self) -> None:
        with self._lock, self._server.atomic():
            self._drawing.wish()
            self._panel.scale = self._drawing.scale
            self._handles.draw()
            self._panel.refresh()

    def _moment(self) -> None:
        self._drawing.moment()
        self._panel.scale = self._drawing.scale
        self._panel.moment()

    def _ready(self) -> None:
        """Have the clip of the stage on the timeline."""
        clip = self.stage.clip
        assert clip is not None
        self._timeline.load(clip.duration)
        self._timeline.speed = min(SPEEDS, key=lambda one: abs(clip.duration / one - TAKES))
        self._panel.set_speed(self._timeline.speed)
        self._playing(False)
        self._show_all()
