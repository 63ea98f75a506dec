"""A hit that reckons with a model of the drives: the same inertia in plan, swing and landing."""

from dataclasses import replace

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.constants import GRAVITY
from hitjoints.impact.shown_inertia import shown_inertia, shown_mobility

MODELS = ("rigid", "rotor", "composite", "elastic")
WISH = {"position": (0.5, 0.3, 0.5), "goal": (0.5, 0.34, 0.5), "mass": 1.2, "size": (0.1,) * 3}
TABLE = {"restitution": 0.4, "friction": 0.3, "spread": {"friction": 0.02}}


def wanted(model, joint=6):
    setting = hj.HitSetting(hj.RobotChoice("iiwa14"), drives=hj.Drives(model, contact_time=0.02))
    return hj.Hit(joint, **WISH, **TABLE, setting=setting)


@pytest.fixture(scope="module")
def arm():
    return hj.load_robot("iiwa14")


def judged(arm, q, hit):
    """Return the inertia of a hit's model by the public functions."""
    contact, h, model = hit.chosen_contact, hit.direction, hit.setting.drives.model
    if model != "elastic":
        return hj.impact_inertia(arm, q, contact, h, model)
    found = hj.elastic_impact(arm, q, contact, h, hit.mass, 0.7, hit.restitution, 0.02)
    return found.equivalent


@pytest.mark.parametrize("model", MODELS)
def test_every_model_has_a_mobility_with_its_inertia(arm, model):
    hit = wanted(model)
    contact = arm.contact(hit.chosen_contact)
    for q in np.random.default_rng(2).uniform(arm.lower, arm.upper, (10, 7)):
        mobility = shown_mobility(arm, q, contact, hit)
        np.testing.assert_allclose(mobility, mobility.T, atol=1e-12)
        assert np.linalg.eigvalsh(mobility)[0] > -1e-12
        shown = shown_inertia(arm, q[None], contact, hit)[0]
        assert 1 / (hit.direction @ mobility @ hit.direction) == pytest.approx(shown, rel=1e-9)
        assert shown == pytest.approx(judged(arm, q, hit), rel=1e-9)


@pytest.mark.parametrize("model", MODELS)
def test_plan_swing_and_landing_reckon_with_one_inertia(arm, model):
    hit = wanted(model)
    planned = hj.plan(hit, certificate=False)
    best = planned.best
    assert best.inertia == pytest.approx(judged(arm, best.q, hit), rel=1e-9)
    assert planned.impact == model
    swung = hj.swing(planned)
    shown = judged(arm, swung.q_hit, hit)
    assert swung.inertia == pytest.approx(shown, rel=1e-9)
    assert swung.flux == pytest.approx(hj.hitting_flux(shown, hit.mass, swung.speed), rel=1e-12)
    assert swung.flux == pytest.approx(hit.flux, rel=5e-3)
    assert swung.sendable
    said = swung.as_dict()
    assert (said["impact"], said["inertia"]) == (model, swung.inertia)
    links = hj.directional_inertia(arm, swung.q_hit, hit.chosen_contact, hit.direction)
    assert said["links_inertia"] == pytest.approx(links, rel=1e-12)
    # Eq. 3, and friction on the way.
    landed = hj.landing(arm, swung.q_hit, hit, swung.speed)
    leaving = (1 + hit.restitution) * swung.flux
    reached = np.linalg.norm(landed.nominal[:2] - hit.position[:2])
    assert reached == pytest.approx(leaving**2 / (2 * hit.friction * GRAVITY), rel=1e-3)


@pytest.mark.parametrize("model", MODELS[1:])
def test_a_rollout_strikes_with_the_speed_that_the_model_asks_for(arm, model):
    hit = wanted(model)
    planned = hj.plan(hit, certificate=False)
    rolled = hj.rollout(planned)
    asked = hit.speed(judged(arm, rolled.q_hit, hit))
    assert rolled.impact.speed == pytest.approx(asked, rel=0.02)
    assert rolled.hit.setting.drives.model == "rigid"


def test_more_inertia_needs_less_speed(arm):
    q = hj.plan(wanted("rigid"), certificate=False).best.q
    rigid, rotor = (wanted(model).speed(judged(arm, q, wanted(model))) for model in MODELS[:2])
    assert rotor < 0.95 * rigid


def test_the_file_keeps_the_model(tmp_path):
    drives = hj.Drives("elastic", 0.005, stiffness=np.full(7, 2e4), rotor_inertia=0.4)
    hit = wanted("rigid").changed(setting=hj.HitSetting(hj.RobotChoice("iiwa14"), drives=drives))
    hit.save(tmp_path / "hit.toml")
    again = hj.load_hit(tmp_path / "hit.toml")
    assert again.setting.drives == drives
    assert again.as_dict() == hit.as_dict()
    assert "impact" not in wanted("rigid").changed(setting=hj.HitSetting()).as_dict()


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ('model = "soft"', ("impact", "soft", "elastic")),
        ("contact_time = 0.0", ("contact_time", "above 0 s")),
        ('stiffness = "hard"', ("stiffness", "hard")),
        ("gap = 1.0", ("gap", "contact_time")),
    ],
)
def test_a_wrong_model_is_one_line(tmp_path, run, line, words):
    path = tmp_path / "hit.toml"
    wanted("rigid").save(path)
    text = path.read_text().partition("[impact]")[0]
    path.write_text(text + "\n[impact]\n" + line + "\n")
    outcome = run("hit", path)
    assert (outcome.code, outcome.err.count("\n")) == (1, 1)
    for word in words:
        assert word in outcome.err


def test_commands_agree(tmp_path, run):
    path, saved = tmp_path / "hit.toml", tmp_path / "plan.json"
    wanted("rotor").save(path)
    told = run("hit", path, "--json").json
    assert told["hit"]["impact"]["model"] == "rotor"
    swung = told["swing"]
    assert swung["inertia"] > 1.5 * swung["links_inertia"]
    assert run("hit", path, "--impact", "rigid", "--json").json["swing"]["impact"] == "rigid"
    assert run("plan", "--hit", path, "--out", saved, "--json").json["impact"] == "rotor"
    by_plan = run("swing", "--plan", saved, "--json").json
    by_file = run("swing", "--hit", path, "--json").json
    by_option = run("swing", "--hit", path, "--impact", "composite", "--json").json
    assert by_plan["impact"] == by_file["impact"] == "rotor"
    assert by_option["impact"] == "composite"


@pytest.mark.parametrize("model", ["rigid", "rotor", "elastic"])
def test_the_engine_judges_the_arm_that_the_hit_reckons_with(arm, model):
    pytest.importorskip("mujoco")
    hit = wanted(model)
    swung = hj.swing(arm, hit)
    found = hj.simulate(swung)
    leaving = (1 + hit.restitution) * swung.flux
    # The rotors behind springs take part within the contact's 20 ms, in which the arm moves on.
    off = 0.05 if model == "elastic" else 2e-3
    assert found.simulated["object_speed"] == pytest.approx(leaving, rel=off)
    if model == "elastic":
        told = found.elastic
        assert found.simulated["object_speed"] == pytest.approx(told.object_speed, rel=0.01)
        assert found.setting.contact_time == 0.02
    else:
        assert found.elastic is None
        assert found.predicted.inertia == pytest.approx(swung.inertia, rel=1e-9)
    if model != "rigid":
        alone = hj.simulate(replace(swung, hit=swung.hit.changed(setting=hj.HitSetting())))
        assert alone.simulated["object_speed"] < 0.97 * leaving
