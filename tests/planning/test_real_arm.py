"""Plans by the inertia that an arm with drives shows."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.hitting.deliverable import deliverable_speed

PLACE, H, MASS = (0.5, 0.3, 0.5), (0.0, 1.0, 0.0), 2.0


@pytest.fixture(scope="module")
def plans():
    arm = hj.load_robot("iiwa14")

    def planned(model, **how):
        drives = hj.Drives(model, contact_time=0.02)
        return hj.plan(arm, PLACE, H, MASS, joints=[6, 7], certificate=False, drives=drives, **how)

    return arm, planned


def test_rotor_is_planned_for_exactly(plans):
    arm, planned = plans
    rigid, rotor = planned("rigid"), planned("rotor")
    for one, alone in zip(rotor.candidates, rigid.candidates, strict=True):
        joint = one.joint
        assert one.inertia == pytest.approx(
            hj.impact_inertia(arm, one.q, joint, H, "rotor"), rel=1e-12
        )
        # The best of the links alone has less: the search was made for the rotors.
        assert one.inertia >= hj.impact_inertia(arm, alone.q, joint, H, "rotor") - 1e-9
        samples = hj.place_joint(arm, joint, np.tile(PLACE, (400, 1)), seed=5)
        away = [q for q, ok in zip(samples.q, samples.solved, strict=True) if ok]
        values = hj.impact_inertia(arm, np.array(away), joint, H, "rotor")
        ends = [hj.position(arm, q, joint + 1)[1] if joint < 7 else None for q in away]
        allowed = [v for v, end in zip(values, ends, strict=True) if end is None or end < PLACE[1]]
        if joint == 6:
            assert one.inertia >= max(allowed) - 1e-6
        flux = hj.hitting_flux(one.inertia, MASS, one.speed)
        assert one.flux == pytest.approx(flux, rel=1e-9)
    assert rigid.as_dict()["impact"] == "rigid"
    assert rotor.as_dict()["impact"] == "rotor"


@pytest.mark.parametrize("objective", ["inertia", "flux", "straight-flux", "deliverable"])
def test_composite_is_searched_for(plans, objective):
    arm, _ = plans
    found = hj.plan(
        arm, PLACE, H, MASS, joints=[6], objective=objective, drives=hj.Drives("composite")
    ).best
    assert found.evidence["certificate"] is None
    shown = hj.impact_inertia(arm, found.q, 6, H, "composite")
    assert found.inertia == pytest.approx(shown, rel=1e-12)
    assert found.straight_flux == pytest.approx(
        hj.hitting_flux(shown, MASS, found.straight_speed), rel=1e-9
    )
    samples = hj.place_joint(arm, 6, np.tile(PLACE, (300, 1)), seed=5).q
    tried = [q for q in samples if hj.position(arm, q, 7)[1] < PLACE[1]]
    shown = hj.impact_inertia(arm, np.array(tried), 6, H, "composite")
    if objective == "inertia":
        most = shown
    elif objective == "deliverable":
        speeds = [deliverable_speed(arm, q, arm.contact(6), np.array(H)) for q in tried]
        most = hj.hitting_flux(shown, MASS, np.array(speeds))
    else:
        straight = objective == "straight-flux"
        most = hj.hitting_flux(
            shown, MASS, hj.hitting_speed(arm, np.array(tried), 6, H, straight=straight)
        )
    quantity = {"inertia": "inertia", "deliverable": "deliverable_flux"}.get(
        objective, objective.replace("-", "_")
    )
    assert getattr(found, quantity) >= np.max(most) * (1 - 1e-9)


def test_elastic_ranks_the_best_of_the_links_again(plans):
    arm, planned = plans
    rigid, found = planned("rigid"), planned("elastic")
    for one, alone in zip(found.candidates, rigid.candidates, strict=True):
        np.testing.assert_array_equal(one.q, alone.q)
        assert one.links_inertia == alone.inertia
        speed = one.straight_speed
        shown = hj.elastic_impact(arm, one.q, one.joint, H, MASS, speed, 0.5, 0.02).equivalent
        assert one.inertia == pytest.approx(shown, rel=1e-9)
        for speed, flux in ((one.speed, one.flux), (one.straight_speed, one.straight_flux)):
            assert flux == pytest.approx(hj.hitting_flux(shown, MASS, speed), rel=1e-9)
    best = max(found.candidates, key=lambda one: one.inertia)
    assert found.best.joint == best.joint


def test_the_margin_between_the_joints_shrinks(plans):
    _, planned = plans

    def margin(model):
        six, seven = planned(model).candidates
        return six.inertia / seven.inertia

    assert margin("rigid") > 2 > margin("elastic") > margin("rotor") > 1


def test_the_command(run):
    options = ("plan", "--joint", 6, "--no-certificate", "--json")
    found = run(*options, "--impact", "rotor").json
    assert found["impact"] == "rotor"
    assert found["best"]["inertia"] > 15
    assert run(*options).json["impact"] == "rigid"
    outcome = run("plan", "--impact", "rotor", "--robot", "xarm7")
    assert (outcome.code, "rotor_inertia" in outcome.err) == (1, True)
    outcome = run("plan", "--impact", "all")
    assert "choose one of composite, elastic, rigid, rotor" in outcome.err
    assert run("plan", "--contact-time", 0.1).code == 2
