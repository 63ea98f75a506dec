"""Maps of what motions deliver: each number against the rollout it is of, and their stores."""

import numpy as np
import pytest
import xarray as xr

import hitjoints as hj
from hitjoints.errors import InputError
from hitjoints.maps import motion_sweep, run_sweep

AXES = np.array([-0.5, 0.45, 0.9]), np.array([0.1, 0.3]), np.array([0.4, 0.6])
H = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0]])
OPTIONS = {"joints": [5, 7], "samples": 12, "tries": 2, "seed": 3}


@pytest.fixture(scope="module")
def robot():
    return hj.load_robot("iiwa14")


@pytest.fixture(scope="module")
def swept(robot):
    return hj.sweep_motion(robot, *AXES, H, 2.0, **OPTIONS)


def test_dimensions_units_and_origin(swept, robot):
    assert dict(swept.sizes) == {
        "joint": 2, "direction": 2, "x": 3, "y": 2, "z": 2, "axis": 7, "xyz": 3
    }  # fmt: skip
    assert all("units" in swept[name].attrs for name in swept.variables)
    assert swept.attrs["robot_digest"] == robot.digest
    assert swept.attrs["map"] == "motion"


def test_every_cell_is_a_rollout_that_can_be_made_again(swept, robot):
    hits = 0
    for k in swept.joint.values:
        for d in swept.direction.values:
            for x, y, z in np.ndindex(3, 2, 2):
                cell = swept.sel(joint=k, direction=d).isel(x=x, y=y, z=z)
                if not float(cell.reachable):
                    assert np.isnan(cell.hits)
                if not float(cell.hits) > 0:
                    assert np.isnan(cell.flux)
                    assert np.isnan(cell.q).all()
                    continue
                hits += 1
                at, h = [float(cell[name]) for name in "xyz"], cell.direction_vector.values
                hit = hj.Hit(int(k), at, h, 2.0, float(cell.straight_flux))
                one = hj.rollout(
                    robot, hit, q0=cell.q0.values, q_hit=cell.q_hit.values, dt=swept.attrs["dt"]
                )
                assert one.impact is not None
                for name in ("flux", "inertia", "speed", "miss", "time", "direction_error", "q"):
                    expected = getattr(one.impact, name)
                    np.testing.assert_allclose(cell[name], expected, rtol=1e-8, atol=1e-8)
                assert float(cell.torque_ratio) == pytest.approx(one.torque_ratio_max, rel=1e-7)
                assert one.velocity_ratio_max <= 1
                assert one.position_violation_max == 0
                assert float(cell.miss) < 0.02
                most = hj.hitting_speed(robot, cell.q_hit.values, int(k), h, straight=True)
                inertia = hj.directional_inertia(robot, cell.q_hit.values, int(k), h)
                flux = hj.hitting_flux(inertia, 2.0, most)
                assert float(cell.straight_flux) == pytest.approx(flux, rel=1e-6)
                assert float(cell.flux) < 1.1 * flux
    assert hits >= 12


def test_threads_and_blocks_do_not_matter(robot, swept, monkeypatch):
    monkeypatch.setattr(motion_sweep, "POSITIONS_AT_ONCE", 2)
    again = hj.sweep_motion(robot, *AXES, H, 2.0, **OPTIONS, threads=2)
    xr.testing.assert_identical(again.drop_attrs(), swept.drop_attrs())


def test_a_stopped_sweep_goes_on_where_it_was(robot, swept, monkeypatch, tmp_path):
    monkeypatch.setattr(motion_sweep, "POSITIONS_AT_ONCE", 2)
    out = tmp_path / "motion.zarr"

    def stop(done, total):
        if done >= 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        hj.sweep_motion(robot, *AXES, H, 2.0, **OPTIONS, out=out, threads=1, progress=stop)
    with pytest.raises(InputError, match=r"missing or damaged.*sweep_motion"):
        hj.open_map(out)
    computed = []
    monkeypatch.setattr(
        run_sweep,
        "run_blocks",
        lambda question, grid, indices, real=run_sweep.run_blocks, **given: (
            computed.extend(indices) or real(question, grid, indices, **given)
        ),
    )
    whole = hj.sweep_motion(robot, *AXES, H, 2.0, **OPTIONS, out=out)
    assert 0 < len(computed) < 6
    xr.testing.assert_identical(whole.load().drop_attrs(), swept.drop_attrs())
    xr.testing.assert_identical(hj.open_map(out).load().drop_attrs(), swept.drop_attrs())
    with pytest.raises(InputError, match="it holds a motion map"):
        hj.sweep_workspace(robot, *AXES, H, 2.0, joints=[5, 7], samples=12, seed=3, out=out)
    with pytest.raises(InputError, match="another tries"):
        hj.sweep_motion(robot, *AXES, H, 2.0, **OPTIONS | {"tries": 3}, out=out)


@pytest.mark.parametrize(
    ("name", "value"), [("tries", 0), ("dt", 1.0), ("samples", 0), ("seed", -1)]
)
def test_bad_arguments_are_named(robot, name, value):
    with pytest.raises(InputError, match=name):
        hj.sweep_motion(robot, *AXES, H, 2.0, **OPTIONS | {name: value})


GRID = ("--x", "0.3:0.6:2", "--y", "0.1:0.4:2", "--z", "0.5")


def test_the_command_says_what_is_delivered_and_where(run, tmp_path):
    plot, out = tmp_path / "map.png", tmp_path / "map.zarr"
    few = ("--samples", "10", "--tries", "2", "--joint", "6")
    done = run("sweep", "motion", *GRID, *few, "--json", "--plot", plot, "--out", out)
    assert done.code == 0, done.err
    (row,) = done.json["summary"]
    assert {"flux", "straight_flux", "position", "hit", "q", "q0", "torque_ratio"} <= row.keys()
    assert plot.stat().st_size > 10_000
    swept = hj.open_map(out)
    assert row["flux"] == pytest.approx(float(swept.flux.max()))
    table = run("sweep", "motion", *GRID, *few)
    assert table.code == 0
    assert "delivered" in table.words


def test_a_grid_out_of_reach_is_a_no(run):
    done = run("sweep", "motion", "--x", "3:4:2", "--y", "0", "--z", "0", "--samples", "2")
    assert done.code == 3
    assert "no motion hits" in done.err
