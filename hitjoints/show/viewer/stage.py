"""The one state of the viewer: what is wanted, what is planned for it, and what is shown of it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from hitjoints.errors import HitjointsError, InfeasibleError
from hitjoints.goals.landing import Landing, landing
from hitjoints.impact.collision import required_speed
from hitjoints.model.robot import Contact
from hitjoints.rollouts.prepare import placed
from hitjoints.show.arm_faces import box_centre
from hitjoints.show.viewer.assumed import Assumption, assume
from hitjoints.show.viewer.box_place import BoxPlace, box_place
from hitjoints.show.viewer.clip import (
    RECORDED,
    Clip,
    with_slide,
)
from hitjoints.show.viewer.making import made_clip

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike, NDArray

    from hitjoints.hit import Hit
    from hitjoints.model.robot import Robot
    from hitjoints.planning.candidates import Candidate, Verdict
    from hitjoints.planning.plan_record import Plan
    from hitjoints.types import Array

SAME = 1e-9
"""Greatest difference of numbers that are the same after a trip through a browser or a file."""
AT_LIMIT = 1e-3
"""rad, how near a limit a joint counts as at it."""


class Stage:
    """What the viewer shows. Every change of the state is a method; nothing here draws.

    Args:
        robot: the arm.
        hit: that is wanted, with what hits.
        q: (n,) rad, the configuration to begin with.
        contacts: that a plan tries; the robot's usual ones by default.

    Attributes:
        robot: the arm.
        wish: the hit that is wanted, with the contact that was chosen.
        q: (n,) rad, the configuration shown.
        plan: the last plan that was made or loaded, whether it is of this wish or not.
        follows_best: the joint is whichever the plan says is best.
        clip: the motion that can be played.
        time: s, where in it.
    """

    def __init__(
        self, robot: Robot, hit: Hit, q: Array, contacts: Sequence[Contact] | None = None
    ) -> None:
        contact = robot.contact(hit.chosen_contact)
        self.robot, self.wish, self.q = robot, hit.with_contact(contact), q
        self.plan: Plan | None = None
        self.follows_best = False
        self.clip: Clip | None = None
        self.time = 0.0
        self._contacts = {c.joint: c for c in (*(contacts or robot.usual_contacts), contact)}
        self._landing: tuple[Landing | None, str] | None = None
        self._begin: BoxPlace | None = None

    @property
    def contact(self) -> Contact:
        """What hits."""
        return self.wish.chosen_contact

    @property
    def contacts(self) -> tuple[Contact, ...]:
        """What a plan tries: the robot's usual contacts, and whatever was chosen."""
        return tuple(self._contacts[joint] for joint in sorted(self._contacts))

    def change(self, **values: object) -> None:
        """Want something else, by the arguments of `Hit`; motions of the old wish are forgotten.

        Raises:
            InputError: a value cannot be used; the wish stays what it was.
        """
        self._want(self.wish.changed(**values))

    def move_object(self, position: ArrayLike) -> None:
        """Put the object somewhere else, (3,) m; a goal stays as high as it."""
        at = np.asarray(position, dtype=float)
        goal = self.wish.goal
        self.change(position=at, goal=None if goal is None else np.append(goal[:2], at[2]))

    def aim_at(self, goal: ArrayLike) -> None:
        """Want the object to slide to a place, (2,) or (3,) m; it lies as high as the object."""
        at = np.append(np.asarray(goal, dtype=float)[:2], self.wish.position[2])
        filled = assume(self.wish).hit
        told = {name: getattr(filled, name) for name in ("restitution", "friction")}
        self.change(goal=at, direction=None, flux=None, object_speed=None, **told)

    def aim_along(self, direction: ArrayLike) -> None:
        """Want the object hit along a direction (3,), as hard as now."""
        hard = {"object_speed": self.wish.object_speed}
        if self.wish.object_speed is None:
            hard["flux"] = self.wish.flux
        self.change(goal=None, direction=np.asarray(direction, dtype=float), **hard)

    def choose(self, joint: int | None) -> None:
        """Hit with a joint, or with whichever is best, and show what is planned for it."""
        self.follows_best = joint is None
        if joint is None:
            joint = self.contact.joint
            if self.is_planned and self.plan is not None and self.plan.best is not None:
                joint = self.plan.best.joint
        contact = self.robot.contact(self._contacts.get(joint, Contact(joint)))
        self._contacts[joint] = contact
        self._want(self.wish.with_contact(contact))
        if self.candidate is not None:
            self.turn(self.candidate.q)

    def slide_with(self, **values: float) -> None:
        """Let the object slide with another restitution or friction; a motion stays what it is.

        Where a goal says how hard the hit is to be, that changes what is wanted.
        """
        clip, time = self.clip, self.time
        self.change(**values)
        if clip is not None and self.wish.goal is None and clip.kind != RECORDED:
            self.clip = with_slide(self.robot, clip, assume(self.wish).hit)
            self.seek(time)

    def choose_objective(self, objective: str) -> None:
        """Plan by another objective, from now on."""
        self.change(setting=replace(self.wish.setting, objective=objective))

    def turn(self, q: ArrayLike) -> None:
        """Show a configuration (n,) rad.

        Raises:
            InputError: it is outside the limits.
        """
        self.q = self.robot.within_limits(q)

    def place(self) -> None:
        """Bring the contact to the object, from where the arm is.

        Raises:
            InfeasibleError: it is out of reach.
        """
        self.turn(placed(self.robot, self.contact, self.wish.position, self.q))

    def adopt(self, made: Plan) -> None:
        """Keep a plan, and show what it says of the joint chosen, or of the best."""
        self.plan = made
        self._forget()
        if self.is_planned:
            self.choose(None if self.follows_best else self.contact.joint)

    @property
    def is_planned(self) -> bool:
        """The plan is one for this wish."""
        made, wish = self.plan, self.wish
        if made is None:
            return False
        old = made.hit
        vectors = ((old.position, wish.position), (old.direction, wish.direction))
        numbers = ((old.mass, wish.mass), (old.flux or 0.0, wish.flux or 0.0))
        near = all(np.allclose(a, b, rtol=0, atol=SAME) for a, b in (*vectors, *numbers))
        return near and made.objective == wish.setting.objective

    @property
    def needs_plan(self) -> bool:
        """The plan says nothing of this wish, or nothing of this joint."""
        return not any(
            (one.joint, one.offset) == (self.contact.joint, self.contact.offset)
            for one in self.candidates
        )

    @property
    def candidates(self) -> tuple[Verdict, ...]:
        """What the plan says of each joint; nothing when it is of another wish."""
        return self.plan.candidates if self.plan is not None and self.is_planned else ()

    @property
    def candidate(self) -> Candidate | None:
        """What is planned for the joint chosen, if it can do it."""
        for one in self.candidates:
            if one.feasible and (one.joint, one.offset) == (
                self.contact.joint,
                self.contact.offset,
            ):
                return one
        return None

    def make(self, motion: str) -> None:
        """Make a motion to the configuration that was planned; nothing is planned for it.

        Args:
            motion: one of `MOTIONS`.

        Raises:
            InfeasibleError: nothing is planned for this wish and joint, or there is no motion.
            InputError: the arm or the hit lacks what the motion needs.
        """
        one = self.candidate
        if one is None:
            raise InfeasibleError("nothing is planned for this hit and joint: plan first")
        self.show(made_clip(self.robot, self.wish, one.q, self.q, motion))

    def show(self, clip: Clip) -> None:
        """Have a motion to play, from its start; the box slides unless it says how itself."""
        self._forget()
        self.clip = clip
        if clip.slide is None:
            self.clip = with_slide(self.robot, clip, assume(clip.hit).hit)
        self.seek(0.0)

    def seek(self, time: float) -> None:
        """Show a moment of the motion (s)."""
        if self.clip is not None:
            self.time = min(max(time, 0.0), self.clip.duration)
            self.q = self.clip.configuration(self.time)

    @property
    def begin(self) -> BoxPlace:
        """Where the box is before the hit: at the surface of what will hit it, once that is known.

        The point of the hit is one of the arm, inside its link more often than not.
        """
        if self._begin is None:
            self._begin = place = box_place(self.wish)
            q = self._q_hit
            if q is not None:
                h = self.wish.direction
                at = box_centre(self.robot, q, self.contact, h, place.size, place.axes)
                self._begin = BoxPlace(place.size, at, place.axes)
        return self._begin

    @property
    def box(self) -> BoxPlace:
        """Where the box is now."""
        return self.begin if self.clip is None else self.begin.moved(*self.clip.moved(self.time))

    @property
    def _q_hit(self) -> Array | None:
        """The configuration (n,) rad that hits, if it is known."""
        clip, one = self.clip, self.candidate
        if clip is not None and clip.impact_time is not None:
            return clip.configuration(clip.impact_time)
        return None if one is None else one.q

    @property
    def assumption(self) -> Assumption:
        """The wish with all that a slide needs, and what of it is assumed."""
        return assume(self.wish)

    @property
    def rest(self) -> tuple[Landing | None, str]:
        """Where the box comes to rest, or why that is not known."""
        if self._landing is None:
            try:
                self._landing = self._land(), ""
            except HitjointsError as error:
                self._landing = None, str(error)
        return self._landing

    def _land(self) -> Landing:
        hit, clip, one = assume(self.wish).hit, self.clip, self.candidate
        seed = hit.setting.seed
        if self._q_hit is not None and clip is not None and clip.speed is not None:
            return landing(self.robot, self._q_hit, hit, clip.speed, seed=seed)
        if one is None:
            raise InfeasibleError("nothing is planned")
        flux = hit.flux if hit.flux is not None else one.deliverable_flux or one.straight_flux
        speed = float(required_speed(one.inertia, hit.mass, flux))
        return landing(self.robot, one.q, hit, speed, seed=seed)

    @property
    def shares(self) -> dict[str, Array]:
        """How much of each limit each joint takes now, (n,) by name; empty at rest."""
        return {} if self.clip is None else self.clip.share(self.time)

    @property
    def at_limit(self) -> NDArray[np.bool_]:
        """Which joints (n,) are at a position limit, or beyond another one, now."""
        near = (self.q - self.robot.lower < AT_LIMIT) | (self.robot.upper - self.q < AT_LIMIT)
        for share in self.shares.values():
            near = near | (share > 1)
        return np.asarray(near)

    def _want(self, wish: Hit) -> None:
        self.wish = wish
        self._forget()

    def _forget(self) -> None:
        self.clip, self.time, self._landing, self._begin = None, 0.0, None, None
