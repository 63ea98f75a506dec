"""Sweeps over the length of a contact, and the map of the joint that shows most."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.maps.contact_time_sweep import crossings
from hitjoints.maps.winning_joint import winning_joint

PLACE, H = (0.5, 0.3, 0.5), (0.0, 1.0, 0.0)


@pytest.fixture(scope="module")
def swept():
    arm = hj.load_robot("iiwa14")
    return arm, hj.sweep_contact_time(arm, PLACE, H, 2.0, np.geomspace(1e-4, 3e-2, 13))


def test_each_value_is_that_of_the_api(swept):
    arm, found = swept
    row = found.sel(joint=6)
    q, speed, time = row.q.values, float(row.straight_speed), float(found.time[5])
    hit = hj.elastic_impact(arm, q, 6, H, 2.0, speed, 0.5, time)
    assert float(row.equivalent[5]) == hit.equivalent
    assert float(row.object_speed[5]) == hit.object_speed
    assert float(row.rotor) == hj.impact_inertia(arm, q, 6, H, "rotor")
    np.testing.assert_allclose(hj.position(arm, q, 6), PLACE, atol=1e-8)


def test_short_contacts_show_the_links(swept):
    _, found = swept
    np.testing.assert_allclose(found.equivalent.isel(time=0), found.rigid, rtol=2e-3)


def test_crossings_lie_where_the_lines_cross(swept):
    _, found = swept
    (one,) = crossings(found)
    assert one.joints == (6, 7)
    assert 6e-3 < one.time < 1e-2
    for joint in one.joints:
        line = found.equivalent.sel(joint=joint)
        between = np.interp(np.log(one.time), np.log(found.time), line)
        assert between == pytest.approx(one.value, rel=1e-9)


def test_the_map_counts_what_is_reached():
    arm = hj.load_robot("iiwa14")
    found = winning_joint(arm, [0.0, 0.5], [0.3, 2.0], 0.5, H, 2.0, (1e-3,), samples=8)
    assert found.equivalent.dims == ("joint", "time", "x", "y")
    assert np.isnan(found.equivalent.sel(y=2.0)).all()
    assert (found.equivalent.sel(x=0.5, y=0.3) > 0).all()


def test_the_command_and_its_figures(run, tmp_path, monkeypatch):
    monkeypatch.setattr("hitjoints.cli.sweep_contact_time.MAPPED", ((0.4, 0.6, 3), (0.2, 0.4, 3)))
    files = [tmp_path / name for name in ("sweep.nc", "lines.png", "map.png")]
    found = run(
        "sweep", "contact-time", "--count", 9, "--out", files[0], "--plot", files[1],
        "--map", files[2], "--json",
    ).json  # fmt: skip
    assert [row["joint"] for row in found["joints"]] == [5, 6, 7]
    assert found["crossings"][0]["joints"] == [6, 7]
    assert all(file.stat().st_size > 5000 for file in files)
    assert "equal inertia" in run("sweep", "contact-time", "--count", 5).out


@pytest.mark.parametrize(
    ("options", "code", "said"),
    [
        (("--longest", "nan"), 1, "longest = nan"),
        (("--robot", "xarm7"), 1, "rotor_inertia"),
        (("--object", "9,0,0"), 3, "no joint reaches"),
    ],
)
def test_refusals(run, options, code, said):
    outcome = run("sweep", "contact-time", *options)
    assert outcome.code == code
    assert said in outcome.err


@pytest.mark.parametrize("model", ["rigid", "rotor", "composite"])
def test_sweep_joint_by_model(model):
    arm = hj.load_robot("iiwa14")
    found = hj.sweep_joint(arm, PLACE, H, 2.0, count=5, joints=[7], impact=model).sel(joint=7)
    q = np.tile(found.q.values, (5, 1))
    q[:, 6] = found.angle
    np.testing.assert_array_equal(found.inertia, hj.impact_inertia(arm, q, 7, H, model))
    flux = hj.hitting_flux(found.inertia.values, 2.0, found.speed.values)
    np.testing.assert_array_equal(found.flux, flux)


def test_sweep_joint_refuses_an_unknown_model(run):
    assert "choose one of composite, rigid, rotor" in run("sweep", "joint", "--impact", "x").err
