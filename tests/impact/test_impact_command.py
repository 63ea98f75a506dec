"""`inspect --impact`: the models side by side, as the API has them."""

import pytest

import hitjoints as hj


def test_all_models_as_the_api_has_them(run):
    found = run(
        "inspect", "--joint", 7, "--mass", 0.4, "--impact", "all", "--contact-time", 0.005,
        "--stiffness", 2e4, "--restitution", 0.7, "--json",
    ).json  # fmt: skip
    arm, h, impact = hj.load_robot("iiwa14"), (0, 1, 0), found["impact"]
    for model in ("rigid", "rotor", "composite"):
        assert impact[model] == hj.impact_inertia(arm, arm.home, 7, h, model)
    assert impact["rigid"] == found["inertia"]
    hit = hj.elastic_impact(arm, arm.home, 7, h, 0.4, found["speed"], 0.7, 0.005, 2e4).as_dict()
    assert {name: impact["elastic"][name] for name in hit} == hit
    assert impact["elastic"]["stiffness_assumed"] is False


def test_bare_models(run):
    outcome = run("inspect", "--impact", "all")
    assert outcome.code == 0
    assert "with rotors" in outcome.words
    assert set(run("inspect", "--impact", "rotor", "--json").json["impact"]) == {"rotor"}
    assert "impact" not in run("inspect", "--json").json


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (("--impact", "all", "--robot", "xarm7"), 1, "rotor_inertia"),
        (("--impact", "stiff"), 1, "impact = 'stiff': choose one of all, composite"),
        (("--impact", "all", "--contact-time", 0), 1, "contact_time = 0"),
        (("--impact", "all", "--stiffness", "1,2"), 1, "stiffness = [1.0, 2.0]: one number, or 7"),
        (("--impact", "all", "--rotor-inertia", "x"), 2, "'x' is not a list of numbers"),
        (("--contact-time", 0.01), 2, "--contact-time needs --impact"),
    ],
)
def test_refusals(run, options, code, said):
    outcome = run("inspect", *options)
    assert outcome.code == code
    assert said in outcome.err


def test_rotors_from_the_command_line(run):
    found = run(
        "inspect", "--robot", "xarm7", "--impact", "rotor", "--rotor-inertia", "0.5", "--json"
    ).json
    arm = hj.load_robot("xarm7")
    expected = hj.impact_inertia(
        arm, arm.home, arm.usual_joint, (0, 1, 0), "rotor", rotor_inertia=0.5
    )
    assert found["impact"]["rotor"] == expected > found["inertia"]
