"""Planned hits in the engine: ideal ones agree with the model, realistic ones tell why not."""

import numpy as np
import pytest

import hitjoints as hj
from benchmarks.simulation import judge, random_simulations
from hitjoints.evidence.physics.simulation import simulate
from hitjoints.hit import Hit


def default_hit(**changes):
    asked = {"position": [0.5, 0.3, 0.5], "direction": [0, 1, 0], "mass": 2.0, "flux": 0.3}
    return Hit(6, **asked | changes)


@pytest.fixture(scope="module")
def ideal(arm):
    return simulate(arm("iiwa14"), default_hit())


@pytest.fixture(scope="module")
def realistic(arm):
    return simulate(arm("iiwa14"), default_hit(), mode="realistic")


def test_random_planned_hits_are_as_predicted():
    results = list(random_simulations(6))
    assert [r.motion.robot.name for r in results] == ["iiwa14"] * 2 + ["iiwa7"] * 2 + ["panda"] * 2
    for figure in judge(results):
        assert figure.met, figure
    for result in results:
        assert result.motion.impact is not None
        assert result.simulated["restitution"] == pytest.approx(
            result.setting.restitution, abs=5e-3
        )


def test_the_prediction_is_eq_3_4_and_11(ideal):
    told, robot, q = ideal.predicted, ideal.motion.robot, ideal.impact.q
    inertia = hj.directional_inertia(robot, q, 6, [0, 1, 0])
    speed = float(hj.jacobian(robot, q, 6)[1] @ ideal.impact.qd)
    assert told.inertia == pytest.approx(inertia, rel=1e-12)
    assert told.speed == pytest.approx(speed, rel=1e-12)
    assert told.flux == pytest.approx(inertia / (inertia + 2) * speed, rel=1e-12)
    assert told.object_speed == pytest.approx(1.5 * told.flux, rel=1e-12)
    # Momentum: what the arm loses, the object has.
    assert -told.rebound * inertia == pytest.approx(2 * told.object_speed, rel=1e-12)
    assert told.travel == pytest.approx(told.object_speed**2 / (2 * 0.3 * 9.81), rel=1e-12)


def test_an_ideal_hit_agrees(ideal):
    assert abs(ideal.errors["inertia"]) < 1e-3
    assert abs(ideal.errors["object_speed"]) < 2e-3
    assert abs(ideal.errors["rebound"]) < 2e-3
    assert abs(ideal.errors["travel"]) < 0.015
    assert ideal.causes == ()
    assert ideal.strike.contacts == 1


def test_the_wrong_inertia_would_be_seen(arm, ideal):
    # h^T Lambda h instead of 1 / (h^T Lambda^-1 h), which is another number.
    Li = hj.inverse_inertia(arm("iiwa14"), ideal.impact.q, 6)
    wrong = float(np.linalg.inv(Li)[1, 1])
    assert abs(ideal.simulated["inertia"] / wrong - 1) > 0.02


def test_a_realistic_hit_tells_each_cause(realistic, ideal):
    names = [cause.name for cause in realistic.causes]
    assert names == ["servo", "contact time", "contact friction", "off-centre", "table"]
    off = {cause.name: realistic.errors_of(cause.alone) for cause in realistic.causes}
    assert off["off-centre"]["object_speed"] < -0.1
    assert off["servo"]["inertia"] > 0
    assert max(off, key=lambda name: abs(off[name]["object_speed"])) == "off-centre"
    # Off-centre alone: (m + lambda) / (m (1 + 12 off^2 / (2 size^2)) + ...) as for a rigid box.
    felt = 2 / (1 + 0.02**2 / (0.02 / 12))
    inertia = ideal.predicted.inertia
    ratio = felt / (inertia + felt) / (2 / (inertia + 2))
    assert off["off-centre"]["object_speed"] == pytest.approx(ratio - 1, abs=3e-3)
    assert abs(realistic.errors["object_speed"]) > 0.02
    assert realistic.simulated["contact_time"] > 0.008


def test_a_single_cause_is_all_there_is(arm):
    result = simulate(arm("iiwa14"), default_hit(), off_centre=0.03)
    (cause,) = result.causes
    assert result.errors_of(cause.alone) == pytest.approx(result.errors_of(result.strike))
    assert abs(result.errors_of(cause.without)["object_speed"]) < 2e-3


def test_the_servos_follow_the_rollout(realistic):
    # After the impact the rollout slows down to rest; the arm is about there at the end.
    rows, motion = realistic.strike.rows, realistic.motion
    assert rows["time"][-1] == pytest.approx(0.2, abs=0.01)
    rest = motion.rows["q"][-1]
    assert np.abs(rows["q"][-1] - rest).max() < 0.05
    assert abs(rows["robot_speed"][-1]) < 0.3 * realistic.predicted.speed


def test_a_servo_without_a_table_lets_the_box_go(arm):
    result = simulate(arm("iiwa14"), default_hit(), servo_gain=50.0)
    slides = result.strike.object_speed**2 / (2 * 0.3 * 9.81)
    assert result.travel == pytest.approx(slides, rel=0.015)


def test_no_travel_without_a_level_table_or_friction(arm):
    for changes, more in (({"direction": [0, 1, 0.3]}, {}), ({}, {"friction": 0.0})):
        result = simulate(arm("iiwa14"), default_hit(**changes), **more)
        assert result.predicted.travel is None
        assert result.simulated["travel"] is None
        assert result.errors["travel"] is None
        assert abs(result.errors["object_speed"]) < 2e-3


def test_a_slanting_hit_cannot_be_realistic(arm):
    with pytest.raises(hj.InputError, match=r"direction .* horizontally"):
        simulate(arm("iiwa14"), default_hit(direction=[0, 1, 0.3]), mode="realistic")


def test_no_hit_nothing_to_simulate(arm):
    robot = arm("iiwa14")
    hit = default_hit()
    q = hj.place_joint(robot, 6, [0.42, 0.2998, 0.5], start=robot.home).q[0]
    with pytest.raises(hj.InfeasibleError, match="no hit: off the line"):
        simulate(robot, hit, q0=q)
    with pytest.raises(hj.InfeasibleError, match="beyond the maximum"):
        simulate(robot, default_hit(flux=3.0))


def test_same_input_same_bits(arm, ideal):
    again = simulate(arm("iiwa14"), default_hit())
    assert again.simulated == ideal.simulated


def test_the_data_set_says_what_it_holds(ideal):
    data = ideal.dataset
    assert data.robot_speed.attrs["units"] == "m/s"
    assert set(data.sizes) == {"time", "axis", "coordinate", "component", "slide_time"}
    assert float(data.object_speed[-1]) == pytest.approx(ideal.simulated["object_speed"])
    assert float(data.slide_speed[-1]) < 1e-3
    assert data.attrs["predicted_inertia"] == ideal.predicted.inertia
    assert data.attrs["restitution"] == 0.5
