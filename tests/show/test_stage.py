"""The viewer's state, without a browser: what is wanted, planned, played and shown."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.goals.landing import landing
from hitjoints.show.viewer.box_place import box_place
from hitjoints.show.viewer.making import planned
from hitjoints.show.viewer.stage import Stage

AT, ALONG = (0.5, 0.3, 0.5), (0.0, 1.0, 0.0)


@pytest.fixture(scope="module")
def robot():
    return hj.load_robot("iiwa14")


def wanted(**more):
    return hj.Hit(
        6, AT, ALONG, 2.0, 0.3, restitution=0.5, friction=0.3, size=(0.1, 0.12, 0.1), **more
    )


@pytest.fixture(scope="module")
def plan(robot):
    stage = Stage(robot, wanted(), robot.home)
    return planned(robot, stage.wish, stage.contacts)


@pytest.fixture
def stage(robot, plan):
    made = Stage(robot, wanted(), robot.home)
    made.adopt(plan)
    return made


def test_a_plan_that_was_made_is_shown_as_it_is(stage, plan):
    chosen = next(one for one in plan.candidates if one.joint == 6)
    assert stage.is_planned
    assert stage.candidate is chosen
    np.testing.assert_array_equal(stage.q, chosen.q)
    assert [one.joint for one in stage.candidates] == [5, 6, 7]


def test_another_joint_shows_what_is_planned_for_it(stage, plan):
    able = next(one for one in plan.candidates if one.feasible and one.joint != 6)
    stage.choose(able.joint)
    np.testing.assert_array_equal(stage.q, able.q)
    assert not stage.needs_plan
    stage.choose(4)
    assert stage.candidate is None
    assert stage.needs_plan
    stage.choose(None)
    assert stage.contact.joint == plan.best.joint


# A rollout steers by speeds and comes near it, on the same branch.
@pytest.mark.parametrize(("motion", "near"), [("swing", 1e-3), ("rollout", 0.2)])
def test_a_motion_strikes_in_the_configuration_that_was_planned(stage, motion, near):
    """Nothing is planned for it again: another branch would do as well."""
    q = stage.candidate.q
    stage.make(motion)
    clip = stage.clip
    np.testing.assert_allclose(clip.configuration(clip.impact_time), q, atol=near)
    assert clip.hit.flux_of(
        hj.directional_inertia(stage.robot, q, 6, ALONG), clip.speed
    ) == pytest.approx(0.3, rel=0.05)


def test_a_swing_from_here_starts_here(stage):
    here = stage.robot.home + 0.05
    stage.turn(here)
    stage.make("swing from here")
    np.testing.assert_allclose(stage.q, here, atol=1e-9)


def test_the_box_moves_when_it_is_hit_and_stops_where_landing_says(stage):
    stage.make("swing")
    clip, begin = stage.clip, stage.begin.centre
    stage.seek(clip.impact_time)
    np.testing.assert_array_equal(stage.box.centre, begin)
    ways = []
    for time in np.linspace(clip.impact_time, clip.duration, 20):
        stage.seek(time)
        ways.append((stage.box.centre - begin)[1])
    assert (np.diff(ways) >= 0).all()
    said = landing(
        stage.robot, clip.configuration(clip.impact_time), stage.wish, clip.speed, samples=2
    )
    np.testing.assert_allclose(stage.box.centre - begin, said.nominal - AT, atol=1e-6)


def test_what_it_slides_with_can_be_changed_under_the_motion(stage):
    stage.make("swing")
    stage.seek(stage.clip.duration)
    far = stage.box.centre[1]
    stage.slide_with(friction=0.6)
    stage.seek(stage.clip.duration)
    begin = stage.begin.centre[1]
    assert stage.box.centre[1] - begin == pytest.approx((far - begin) / 2, rel=1e-3)


def test_no_motion_without_a_plan_for_it(stage):
    stage.move_object((0.5, 0.35, 0.5))
    assert not stage.is_planned
    assert stage.candidates == ()
    with pytest.raises(InfeasibleError, match="plan first"):
        stage.make("swing")


def test_a_change_forgets_the_motion_and_keeps_the_rest(stage):
    stage.make("swing")
    stage.seek(1.0)
    stage.change(mass=1.0)
    assert stage.clip is None
    assert stage.time == 0.0
    assert stage.wish.flux == 0.3
    assert stage.wish.size is not None


def test_a_goal_gives_direction_and_flux_and_back(stage):
    stage.aim_at((0.7, 0.5))
    assert stage.wish.direction == pytest.approx(np.array((1, 1, 0)) / np.sqrt(2))
    speed = np.sqrt(2 * 0.3 * 9.81 * np.hypot(0.2, 0.2))
    assert stage.wish.flux == pytest.approx(speed / 1.5, rel=1e-3)
    stage.move_object((0.5, 0.3, 0.6))
    assert stage.wish.goal.tolist() == [0.7, 0.5, 0.6]
    flux = stage.wish.flux
    stage.aim_along((0, 0, 1))
    assert stage.wish.goal is None
    assert stage.wish.flux == flux
    assert stage.wish.direction.tolist() == [0, 0, 1]


def test_a_wish_that_is_none_changes_nothing(stage):
    before = stage.wish
    for work in (
        lambda: stage.aim_along((0, 0, 0)),
        lambda: stage.change(mass=-1.0),
        lambda: stage.aim_at(AT[:2]),
    ):
        with pytest.raises(InputError):
            work()
    assert stage.wish is before
    with pytest.raises(InputError, match="joint 4"):
        stage.turn([0, 0, 0, 3, 0, 0, 0])


def test_what_is_assumed_is_said(robot):
    bare = Stage(robot, hj.Hit(6, AT, ALONG, 2.0, 0.3), robot.home)
    assert bare.assumption.words == ("restitution 0.5; friction 0.3; standard deviations of 10 %")
    told = Stage(robot, wanted(spread={"mass": 0.1}), robot.home)
    assert told.assumption.words == ""
    assert told.assumption.hit is told.wish


def test_where_the_box_stops_is_known_before_a_motion_is_made(stage):
    found, why = stage.rest
    assert why == ""
    flux = 0.3
    way = (1.5 * flux) ** 2 / (2 * 0.3 * 9.81)
    assert found.nominal[1] - AT[1] == pytest.approx(way, rel=1e-3)
    stage.aim_along((0, 1, 1))
    found, why = stage.rest
    assert found is None
    assert "nothing is planned" in why


def test_joints_at_their_limits_are_told(stage):
    robot = stage.robot
    q = robot.home.copy()
    assert not Stage(robot, wanted(), q).at_limit.any()
    q[3] = robot.lower[3]
    stage.turn(q)
    assert stage.at_limit.tolist() == [False, False, False, True, False, False, False]


def test_a_motion_beyond_a_limit_is_red_while_it_is(stage):
    stage.make("rollout")
    shares = stage.clip.shares["torque"]
    row = int(np.argmax(shares.max(axis=1)))
    assert shares[row].max() > 1  # a rollout reaches any velocity at once
    stage.seek(stage.clip.times[row])
    assert stage.at_limit[int(np.argmax(shares[row]))]


@pytest.mark.parametrize("yaw", [0.0, 0.3, -0.6])
def test_the_line_of_the_hit_passes_through_the_boxs_centre(yaw):
    size = (0.1, 0.2, 0.06)
    hit = hj.Hit(6, AT, (1, 1, 0), 1.0, 0.3, size=size, yaw=yaw)
    box = box_place(hit)
    way = box.centre - AT
    assert np.linalg.norm(np.cross(way, hit.direction)) < 1e-12
    # The point that is hit lies on the face whose normal is the first axis.
    local = box.axes.T @ (np.array(AT) - box.centre)
    assert local[0] == pytest.approx(-size[0] / 2)
    np.testing.assert_allclose(box.axes.T @ box.axes, np.eye(3), atol=1e-12)
    assert box.bottom == pytest.approx(AT[2] - size[2] / 2)
    assert box.axes[:, 0] @ hit.direction == pytest.approx(np.cos(yaw))


def test_the_box_stands_at_the_surface_of_what_hits_it(stage):
    """Not at the joint's origin, which lies inside the link."""
    import coal
    import pinocchio as pin

    box, robot, q = stage.begin, stage.robot, stage.candidate.q
    geometry = pin.GeometryData(robot.collision_model)
    pin.updateGeometryPlacements(
        robot.model, robot.model.createData(), robot.collision_model, geometry, q
    )
    face = box.centre - box.size[0] / 2 * box.axes[:, 0]

    def gap(point):
        request, ball = (
            coal.DistanceRequest(),
            (coal.Sphere(1e-4), coal.Transform3s(np.eye(3), point)),
        )
        return min(
            coal.distance(shape.geometry, coal.Transform3s(where.rotation, where.translation),
                          *ball, request, coal.DistanceResult())
            for shape, where in zip(
                robot.collision_model.geometryObjects, geometry.oMg, strict=True
            )
            if shape.parentJoint in (5, 6)
        )  # fmt: skip

    ahead = 0.002 * stage.wish.direction
    assert gap(face + ahead) > 0
    assert gap(face - ahead) <= 0
    assert box.centre[1] - AT[1] > box.size[0] / 2
