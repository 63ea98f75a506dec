"""Boxes hit off centre, turned, high and low in the engine: they end where the law says."""

import math

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.evidence.physics.engine_box import add_box, add_table, set_options
from hitjoints.evidence.physics.slide import is_tipped, turned
from hitjoints.goals.box_rest import predict_rest
from hitjoints.goals.sliding import slide_to_rest
from hitjoints.hit_setting import HitSetting, RobotChoice
from hitjoints.model.engine import engine

SIZE = (0.2, 0.15, 0.12)
HERE = (0.5, 0.3, 0.5)


def wanted(**given):
    usual = {"direction": (0, 1, 0), "mass": 1.0, "flux": 0.5, "restitution": 0.4,
             "friction": 0.25, "size": SIZE}  # fmt: skip
    return hj.Hit(6, HERE, **(usual | given))


@pytest.mark.parametrize("support", ["corners", "face"])
@pytest.mark.parametrize(
    "where",
    [
        {},
        {"off_centre": 0.03},
        {"yaw": 0.25, "off_centre": -0.01},
        {"height": 0.02},
        {"height": -0.02},
        {"height": 0.015, "yaw": -0.2, "off_centre": 0.02},
    ],
)
def test_a_box_ends_where_the_law_says(arm, support, where):
    found = hj.simulate(arm("iiwa14"), wanted(), support=support, **where)
    told, rest = found.predicted_rest, found.rest
    assert rest.speed == pytest.approx(told.speed, rel=3e-3)
    assert rest.spin == pytest.approx(told.spin, rel=5e-3, abs=2e-3)
    assert rest.miss(told) < (0.01 if where.get("height") else 0.003) * told.distance
    assert math.degrees(rest.yaw - told.yaw) == pytest.approx(0, abs=2)
    assert not rest.tipped
    assert found.strike.restitution == pytest.approx(0.4, abs=2e-3)


def test_the_law_is_that_of_landings(arm):
    robot, hit = arm("iiwa14"), wanted(yaw=0.2)
    q = hj.place_joint(robot, 6, HERE, start=robot.home).q[0]
    places = {"off_centre": 0.02, "height": 0.01, "support": "corners"}
    told = predict_rest(robot, q, hit, 1.0, **places)
    landed = hj.landing(robot, q, hit, 1.0, samples=2, **places)
    assert told.place == pytest.approx(landed.nominal, abs=1e-12)
    assert told.yaw == pytest.approx(landed.yaw, abs=1e-12)
    along, aside = told.distance * np.cos(told.direction), told.distance * np.sin(told.direction)
    left = np.array([-hit.direction[1], hit.direction[0], 0])
    assert told.place == pytest.approx(hit.position + along * hit.direction + aside * left)


def test_a_hit_says_what_its_box_is(arm):
    robot, hit = arm("iiwa14"), wanted(yaw=0.2, restitution=0.7, friction=0.4)
    found = hj.simulate(robot, hit)
    how = found.setting
    assert (how.restitution, how.friction, how.size, how.yaw) == (0.7, 0.4, SIZE, 0.2)
    assert hj.simulate(robot, hit, yaw=0.0, friction=0.3).setting.yaw == 0.0


def test_a_hit_with_its_arm_is_planned(arm):
    choice = HitSetting(robot=RobotChoice("iiwa14"), joints=(6,))
    found = hj.simulate(wanted().changed(contact=None, setting=choice))
    assert found.motion.robot.name == "iiwa14"
    assert found.impact.contact.joint == 6
    assert found.setting.size == SIZE
    assert found.rest.miss(found.predicted_rest) < 3e-3 * found.rest.distance


@pytest.mark.parametrize("support", ["corners", "face"])
@pytest.mark.parametrize(("velocity", "spin", "mu"), [((0.8, 0.3), 4.0, 0.3), ((1.5, 0), 6, 0.5)])
def test_the_table_lifts_nothing_that_slips(support, velocity, spin, mu):
    """The path of a turning box curls as it should: its load is that of springs alone."""
    mujoco = engine()
    spec = mujoco.MjSpec()
    set_options(spec, 1e-4)
    add_box(spec, np.zeros(3), np.eye(3), 1.0, SIZE)
    add_table(spec, np.zeros(3), SIZE, mu, support, 2e-3)
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[:2], data.qvel[5] = velocity, spin
    rows = []
    while np.abs(data.qvel).max() > 1e-3:
        mujoco.mj_step(model, data)
        rows.append(data.qpos.copy())
    told = slide_to_rest([velocity], spin, SIZE, mu, support=support)
    way = told.displacement[0]
    assert np.linalg.norm(rows[-1][:2] - way) < 1e-3 * np.linalg.norm(way)
    assert math.degrees(turned(np.array(rows)[:, 3:]) - told.yaw[0]) == pytest.approx(0, abs=0.4)
    assert np.ptp(np.array(rows)[:, 2]) < 1e-4  # it does not hop


def test_a_box_that_falls_over_is_told_to_and_does(arm):
    size = (0.08, 0.12, 0.2)
    found = hj.simulate(
        arm("iiwa14"), wanted(size=size, friction=0.2), height=0.08, support="corners"
    )
    assert found.predicted_rest is None
    assert "tip over" in found.unpredicted
    assert found.rest.tipped
    assert found.as_dict()["rest"]["predicted"] is None


def test_when_a_box_has_tipped():
    def about_y(degrees):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        return np.array([c, 0, s, 0, 1, 0, -s, 0, c])

    balance = math.degrees(math.atan(0.2 / 0.12))
    assert not is_tipped(about_y(balance - 0.1), SIZE)
    assert is_tipped(about_y(balance + 0.1), SIZE)


@pytest.mark.parametrize(
    ("name", "value", "words"),
    [
        ("yaw", 1.0, "another face"),
        ("yaw", 0.7, "misses the box"),
        ("height", 0.05, "misses the box"),
        ("height", math.nan, "misses the box"),
        ("support", "feet", "corners, face"),
    ],
)
def test_what_cannot_be_hit(arm, name, value, words):
    with pytest.raises(hj.InputError, match=f"{name} = .*{words}"):
        hj.simulate(arm("iiwa14"), wanted(size=(0.1, 0.05, 0.1)), **{name: value})


def test_the_command(run):
    found = run("simulate", "--yaw", 0.2, "--height", 0.01, "--support", "corners", "--json").json
    rest = found["rest"]
    assert set(rest) == {"predicted", "simulated", "reason", "miss"}
    assert rest["miss"] < 1e-3
    assert (found["setting"]["yaw"], found["setting"]["height"]) == (0.2, 0.01)
    assert {cause["cause"] for cause in found["shares"]} == {"turned box", "height"}
    outcome = run("simulate", "--off-centre", 0.02)
    for word in ("The box, at rest", "spin", "distance", "from the predicted place"):
        assert word in outcome.words
