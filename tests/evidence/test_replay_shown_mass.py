"""Recorded hits under each model of the drives, and the stiffness that explains them."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.evidence.recordings.replayed_hit import ReplayedHit
from hitjoints.evidence.recordings.shown_mass import GRID, ShownMass, fit_stiffness, with_models
from hitjoints.model.robot import Contact

H = [0.0, 1.0, 0.0]


def hits_by(stiffness, noise=0.0, count=8):
    """Return hits whose measured balance is what a stiffness shows."""
    arm, random = hj.load_robot("iiwa14"), np.random.default_rng(4)
    found = []
    for i in range(count):
        q = arm.home + random.uniform(-0.3, 0.3, 7)
        tool = Contact(7, (0.0, 0.0, 0.15))
        hit = ReplayedHit(f"hit_{i}", "iiwa14", ok=True, mass=0.4, direction=H, robot_speed=0.7)
        hit = with_models(hit, arm, q, tool, contact_time=0.004)
        shown = hj.elastic_impact(arm, q, tool, H, 0.4, 0.7, 0.5, 0.004, stiffness).shown
        object.__setattr__(hit, "unpushed_mass", shown * np.exp(random.normal(0, noise)))
        found.append(hit)
    return found


def test_models_are_those_of_the_api():
    arm, tool = hj.load_robot("iiwa14"), Contact(7, (0.0, 0.0, 0.15))
    hit = ReplayedHit("one", "iiwa14", ok=True, mass=0.4, direction=H, robot_speed=0.7)
    told = with_models(hit, arm, arm.home, tool, stiffness=2e4).shown_mass
    for model in ("rigid", "rotor", "composite"):
        assert getattr(told, model) == hj.impact_inertia(arm, arm.home, tool, H, model)
    one = hj.elastic_impact(arm, arm.home, tool, H, 0.4, 0.7, 0.5, 0.02, 2e4)
    assert told.elastic == one.shown
    assert len(told.curve) == len(GRID)


def test_a_stiffness_is_found_again():
    true = float(GRID[33])
    fitted = fit_stiffness(hits_by(true))
    assert fitted.value == fitted.low == fitted.high == true
    assert fitted.error == pytest.approx(0.0, abs=1e-12)
    assert not fitted.at_edge


def test_noise_widens_the_interval():
    fitted = fit_stiffness(hits_by(float(GRID[33]), noise=0.3))
    assert fitted.low <= fitted.value <= fitted.high
    assert fitted.low < fitted.high
    assert 0.05 < fitted.error < 0.6


def test_too_few_hits_and_unknown_rotors():
    assert fit_stiffness(hits_by(1e4)[:2]) is None
    arm = hj.load_robot("xarm7")
    hit = ReplayedHit("one", "xarm7", ok=True, mass=0.4, direction=H, robot_speed=0.7)
    told = with_models(hit, arm, arm.home, Contact(7)).shown_mass
    assert told == ShownMass(told.rigid, None, told.composite, None)


def test_the_command(run):
    found = run("replay", "--impact", "--rotor-inertia", "1.5", "--json").json
    assert found["stiffness"]["hits"] == 4
    for hit in found["hits"]:
        models = hit["shown_mass"]
        assert models["rigid"] == pytest.approx(hit["inertia"], rel=1e-4)
        assert models["rotor"] > models["rigid"]
        assert hit["unpushed_mass"] > hit["inertia"]
    words = run("replay", "--impact").words
    assert "too few hits of arms whose rotor inertia is known" in words
    assert "less controller" in words
    assert run("replay", "--json").json["hits"][0]["shown_mass"] is None


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--contact-time", "0"), "contact_time = 0"),
        (("--impact", "--stiffness", "-3"), "stiffness = -3"),
    ],
)
def test_refusals(run, options, said):
    outcome = run("replay", *options)
    assert outcome.code == 1
    assert said in outcome.err + outcome.out
