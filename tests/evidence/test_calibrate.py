"""Calibration: laws that are found again, intervals that hold, and real landings."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import hitjoints as hj
from hitjoints.evidence.calibration.landing_law import LandingLaw, student
from hitjoints.evidence.calibration.landing_rows import PastLanding

LANDINGS = Path(__file__).parent.parent / "data" / "landing"
HEADER = "arm,flux,distance,hit_x,start_x,yaw_qz\n"


def made(random, count, scatter, arm="7"):
    flux = random.uniform(0.4, 1.0, count)
    offset, yaw = random.normal(0, 0.01, count), random.normal(0, 0.04, count)
    log = -0.7 + 2.3 * np.log(flux / 0.7) + 5 * offset - 2 * yaw + 3 * yaw * np.log(flux / 0.7)
    distance = np.exp(log + random.normal(0, scatter, count))
    columns = (flux, distance, offset, yaw)
    return [PastLanding(arm, *map(float, row)) for row in zip(*columns, strict=True)]


def test_a_law_without_scatter_is_found_again():
    rows = made(np.random.default_rng(0), 40, 0.0)
    law = LandingLaw(rows[:30])
    for row in rows[30:]:
        assert law.foresee(row).distance == pytest.approx(row.distance, rel=1e-9)
    assert law.scatter == pytest.approx(0.0, abs=1e-9)


def test_nine_in_ten_land_in_the_interval():
    random = np.random.default_rng(1)
    held = []
    for _ in range(40):
        rows = made(random, 30, 0.15) + made(random, 25, 0.15, "14")
        law = LandingLaw(rows)
        new = made(random, 10, 0.15) + made(random, 10, 0.15, "14")
        for row in new:
            told = law.foresee(row)
            held.append(told.low <= row.distance <= told.high)
    assert np.mean(held) == pytest.approx(0.9, abs=0.03)


@pytest.mark.parametrize("freedom", [5, 12, 40, 200])
def test_students_quantile(freedom):
    assert student(freedom) == pytest.approx(stats.t.ppf(0.95, freedom), rel=2e-3)


def test_few_rows_have_the_plain_law():
    rows = [PastLanding("7", flux, 0.5 * flux**2) for flux in (0.4, 0.6, 0.8)]
    told = LandingLaw(rows).foresee(PastLanding("7", 1.0, np.nan))
    assert told.distance == pytest.approx(0.5, rel=1e-12)


def test_real_landings_on_rows_not_used():
    found = hj.calibrate(LANDINGS / "object_1.csv")
    held = found.held_out
    assert found.rows == held.rows == 63
    assert 51 <= held.held <= 62
    assert held.error <= 0.85 * held.baseline_error
    assert held.width <= 0.2
    # The row itself must not be used: another distance of its own changes nothing.
    row, told = found.foreseen[7]
    others = [one for one in found.landings if one is not row]
    assert LandingLaw(others).foresee(row._replace(distance=9.0)) == told


def test_yaw_turns_real_boxes_more_than_a_law_without_friction_would():
    arms = hj.calibrate(LANDINGS / "object_1.csv").as_dict()["arms"]
    assert all(abs(arm["heading"]["yaw"]) > 2.5 for arm in arms.values())


def test_a_failed_hit_and_a_turned_frame_are_seen():
    found = hj.calibrate(LANDINGS / "object_2.csv")
    assert found.rows == 44
    assert any("hardly moves" in note for note in found.notes)
    assert found.law.names == ("one", "flux", "offset")


def test_landings_tell_restitution_and_friction_together():
    soft, hard = (hj.calibrate(LANDINGS / "object_1.csv", restitution=eps) for eps in (0.2, 0.8))
    ratio = (1.8 / 1.2) ** 2
    assert hard.object["friction"] / soft.object["friction"] == pytest.approx(ratio, rel=1e-12)


def test_recordings_tell_them_apart():
    from hitjoints.evidence.recordings.hit_files import EXAMPLES

    found = hj.calibrate(EXAMPLES)
    assert found.rows == 4
    assert 0 <= found.object["restitution"] <= 1
    assert found.held_out is None


def test_the_command(run, tmp_path):
    out, plot = tmp_path / "object.toml", tmp_path / "figure.png"
    table = LANDINGS / "object_1.csv"
    outcome = run("calibrate", table, "--out", out, "--plot", plot, "--json")
    assert outcome.code == 0
    found = outcome.json
    assert found["rows"] == 63
    assert {"coverage", "error", "baseline_error"} <= set(found["held_out"])
    assert found["interval"]["level"] == 0.9
    written = tomllib.loads(out.read_text())["object"]
    assert written["friction"] == pytest.approx(found["object"]["friction"], rel=1e-3)
    assert plot.stat().st_size > 10_000
    assert "56 of 63" in run("calibrate", table).words


def test_a_hit_takes_what_was_found(tmp_path):
    found = hj.calibrate(LANDINGS / "object_1.csv")
    path = tmp_path / "hit.toml"
    more = "position = [0.5, 0.3, 0.5]\nmass = 0.4\n[wish]\ngoal = [0.5, 0.8, 0.5]\n"
    path.write_text(f"schema = 1\n{found.toml()}\n{more}")
    hit = hj.load_hit(path)
    assert hit.friction == pytest.approx(found.object["friction"], rel=1e-3)
    assert hit.spread["friction"] == pytest.approx(found.object["spread"]["friction"], rel=1e-3)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEADER + "7,0.5,nan,0,0,0\n", "line 2: distance = nan"),
        (HEADER + "7,0.5,,0,0,0\n", "line 2: a number in the column distance"),
        (HEADER + "7,0.5,0.001,0,0,0\n", "at least one hit that moved its box"),
        (HEADER, "at least one hit that moved its box"),
        ("a,b\n1,2\n", "no recording"),
        ("", "it is empty"),
    ],
)
def test_what_cannot_be_used(run, tmp_path, text, said):
    path = tmp_path / "landings.csv"
    path.write_text(text)
    outcome = run("calibrate", path)
    assert outcome.code == 1
    assert said in outcome.err


def test_a_file_that_is_not_there(run, tmp_path):
    assert "it is not there" in run("calibrate", tmp_path / "none.csv").err
    assert run("calibrate").code == 2
