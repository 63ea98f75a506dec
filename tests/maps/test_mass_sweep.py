"""From which mass of the object on another joint hits best."""

import numpy as np
import pytest
import xarray as xr

import hitjoints as hj
from hitjoints.datasets.files import write_dataset
from hitjoints.errors import InfeasibleError, InputError
from hitjoints.maps.mass_sweep import crossings_between

AT, H = (0.5, 0.3, 0.5), (0.0, 1.0, 0.0)


def curves(**joints):
    """Return fluxes v / (1 + m / L) of joints with speed v and inertia L, and a count of calls."""
    known = {int(name[1:]): pair for name, pair in joints.items()}
    calls = []

    def best(mass):
        calls.append(mass)
        return {joint: v / (1 + mass / inertia) for joint, (v, inertia) in known.items()}

    return best, calls


def closed_form(a, b):
    """Return the mass at which v_a / (1 + m / L_a) = v_b / (1 + m / L_b)."""
    (va, la), (vb, lb) = a, b
    return (va - vb) / (vb / la - va / lb)


@pytest.mark.parametrize("slow", [(1.0, 8.0), (1.9, 2.5), (0.2, 300.0), (1.0, 1e6)])
def test_two_joints_against_the_closed_form(slow):
    fast = (2.0, 2.0)
    expected = closed_form(fast, slow)
    best, calls = curves(j7=fast, j6=slow)
    (found,) = crossings_between(best, 1e-3, 100.0 * expected)
    assert (found.before, found.after) == (7, 6)
    assert found.mass == pytest.approx(expected, rel=2e-6)
    assert len(set(calls)) < 40


def test_three_joints_one_of_them_best_between():
    fast, middle, slow = (3.0, 1.0), (1.5, 5.0), (0.5, 60.0)
    best, _ = curves(j7=fast, j6=middle, j5=slow)
    first, second = crossings_between(best, 0.01, 100.0)
    assert [(one.before, one.after) for one in (first, second)] == [(7, 6), (6, 5)]
    assert first.mass == pytest.approx(closed_form(fast, middle), rel=2e-6)
    assert second.mass == pytest.approx(closed_form(middle, slow), rel=2e-6)


def test_no_crossing():
    best, calls = curves(j7=(2.0, 3.0), j6=(1.0, 2.0))
    assert crossings_between(best, 0.1, 10.0) == []
    assert len(calls) == 2


@pytest.fixture(scope="module")
def swept():
    return hj.sweep_mass(hj.load_robot("iiwa14"), AT, H, [1.0, 3.0])


def test_every_value_is_that_of_its_configuration(swept):
    robot = hj.load_robot("iiwa14")
    for joint in (6, 7):
        for mass in swept.mass.values:
            cell = swept.sel(joint=joint, mass=mass)
            inertia = hj.directional_inertia(robot, cell.q.values, joint, H)
            speed = hj.hitting_speed(robot, cell.q.values, joint, H)
            assert float(cell.inertia) == pytest.approx(inertia, rel=1e-9)
            assert float(cell.flux) == pytest.approx(
                hj.hitting_flux(inertia, mass, speed), rel=1e-9
            )
    assert bool(np.isnan(swept.flux.sel(joint=5)).all())
    assert bool((swept.flux.max("joint") == swept.flux.sel(joint=swept.best)).all())


def test_the_crossing_against_plans_around_it(swept):
    """Plans of another seed, closer and closer to the crossing: the better joint changes there."""
    robot = hj.load_robot("iiwa14")
    (mass,) = swept.crossing_mass.values
    assert (swept.crossing_before, swept.crossing_after) == (7, 6)
    for beside in (-0.1, -1e-4, 1e-4, 0.1):
        planned = hj.plan(
            robot, AT, H, mass * (1 + beside), joints=[6, 7], objective="flux", seed=5,
            certificate=False,
        )  # fmt: skip
        assert planned.best.joint == (7 if beside < 0 else 6)


@pytest.mark.parametrize("masses", [[], [2.0, 1.0], [-1.0, 1.0], [1.0, float("nan")], [0.0, 1.0]])
def test_masses_that_are_none(masses):
    with pytest.raises(InputError, match="mass = "):
        hj.sweep_mass(hj.load_robot("iiwa14"), AT, H, masses)


def test_other_refusals():
    robot = hj.load_robot("iiwa14")
    with pytest.raises(InputError, match=r"objective = 'inertia': choose one of flux"):
        hj.sweep_mass(robot, AT, H, [1.0], objective="inertia")
    with pytest.raises(InfeasibleError, match="no joint can do it"):
        hj.sweep_mass(robot, (3.0, 0.0, 0.0), H, [1.0], joints=[6])


@pytest.mark.parametrize("ending", ["nc", "csv", "zarr"])
def test_files(swept, tmp_path, ending):
    write_dataset(swept, tmp_path / f"a.{ending}")
    if ending != "csv":
        again = xr.open_dataset(
            tmp_path / f"a.{ending}", engine="h5netcdf" if ending == "nc" else "zarr"
        )
        xr.testing.assert_equal(again, swept)


def test_command(run, tmp_path):
    outcome = run(
        *["sweep", "mass", "--mass", "1:3:2", "--joint", "6", "--joint", "7", "--json"],
        *("--out", tmp_path / "a.nc", "--plot", tmp_path / "a.svg"),
    )
    assert outcome.code == 0
    (crossing,) = outcome.json["crossings"]
    assert (crossing["from"], crossing["to"]) == (7, 6)
    assert 1 < crossing["mass"] < 3
    assert (tmp_path / "a.nc").exists()
    assert (tmp_path / "a.svg").stat().st_size > 1000
