"""Lines and first touches against closed forms and NumPy's polynomials."""

import numpy as np
import pytest

from hitjoints.evidence.recordings import fits
from hitjoints.evidence.recordings.contact import NotHitError, from_object, from_robot
from hitjoints.evidence.recordings.csv_table import RecordingError
from hitjoints.evidence.recordings.glide import measure_glide
from hitjoints.evidence.recordings.layout import Clock

TIME = 1715015836.0 + np.arange(200) / 200
H = np.array([0.0, -1.0, 0.0])


def clock(time=TIME, gaps=()):
    return Clock(time, 0.005, gaps)


def pushed(speed, at=0.5, noise=0.0, friction=0.0):
    """Return positions (N, 3) of an object that is struck at a time."""
    since = np.maximum(TIME - TIME[0] - at, 0)
    way = speed * since - friction * 9.81 * since**2 / 2
    rng = np.random.default_rng(0)
    return np.array([0.5, 0.9, 0.3]) + way[:, None] * H + rng.normal(0, noise, (len(TIME), 3))


def test_a_line_is_that_of_polyfit():
    values = np.random.default_rng(1).normal(size=(200, 3))
    line = fits.fit_line(clock(), values, TIME[40], TIME[48])
    slope, value = np.polyfit(TIME[40:49] - TIME[40], values[40:49], 1)
    np.testing.assert_allclose(line.slope, slope, rtol=1e-9)
    np.testing.assert_allclose(line.at(TIME[40]), value, atol=1e-5)  # s of stamps since 1970
    np.testing.assert_allclose(line.at(line.time + 2), line.value + 2 * slope)


def test_the_line_before_spares_the_row_of_the_contact():
    speed = np.where(np.arange(200) < 100, 1.0, 0.0)
    assert fits.before(clock(), speed, TIME[100]).at(TIME[100]) == pytest.approx(1)
    few = Clock(TIME[98:], 0.005, ())
    line = fits.before(few, np.array([1.0, 1.0, 0.9, *np.zeros(99)]), TIME[100])
    assert line.at(TIME[100]) == pytest.approx(0.9, abs=0.02)


def test_too_few_rows_and_gaps():
    with pytest.raises(RecordingError, match=r"2 rows in 0\.005 s are too few"):
        fits.fit_line(clock(), TIME, TIME[3], TIME[4])
    with pytest.raises(RecordingError, match=r"0 rows in 0 s are too few"):
        fits.fit_line(clock(), TIME, TIME[0] - 9, TIME[0] - 8)
    with pytest.raises(RecordingError, match=r"0\.03 s are needed"):
        fits.fit_line(clock(), TIME, TIME[3], TIME[6], cover=0.03)
    with pytest.raises(RecordingError, match=r"a gap of 0\.1 s"):
        fits.fit_line(clock(gaps=((TIME[5], TIME[5] + 0.1),)), TIME, TIME[3], TIME[9])
    with pytest.raises(RecordingError, match="too few"):
        fits.fit_line(clock(np.full(9, TIME[0])), np.zeros(9), TIME[0] - 1, TIME[0] + 1)


@pytest.mark.parametrize("speed", [0.1, 0.5, 2.0])
@pytest.mark.parametrize("at", [0.5, 0.5013, 0.5049])
def test_touch_of_an_object_that_is_struck(speed, at):
    touch = from_object(clock(), pushed(speed, at, noise=3e-5), H)
    assert touch.source == "object"
    assert touch.time - TIME[0] == pytest.approx(at, abs=5.2e-3)


def test_touch_survives_a_jump_and_a_drift_at_rest():
    position = pushed(1.0)
    position[0] += 0.5e-3  # the first row is often a stale one
    position[30] += 0.02 * np.array([1, 0, 0]) + 0.7e-3 * H
    position[:100] += np.linspace(0, 0.8e-3, 100)[:, None] * H
    position[100:] += 0.8e-3 * H
    assert from_object(clock(), position, H).time - TIME[0] == pytest.approx(0.5, abs=5.2e-3)


def test_no_touch():
    with pytest.raises(NotHitError, match="moves by"):
        from_object(clock(), pushed(0.0, noise=1e-4), H)
    with pytest.raises(RecordingError, match="against the hitting direction"):
        from_object(clock(), pushed(1.0), -H)
    with pytest.raises(RecordingError, match="already moves"):
        from_object(clock(), pushed(1.0, at=-0.1), H)


def test_touch_by_the_robot():
    time = TIME - TIME[0]
    speed = np.interp(time, [0.0, 0.4, 0.5, 0.52, 0.8, 0.95], [0, 1, 1, 0.8, 0.75, 0])
    assert from_robot(clock(), speed, None).time - TIME[0] == pytest.approx(0.5, abs=0.01)
    # A harder brake later on is no contact, if HitTime says so.
    braked = np.interp(time, [0.0, 0.4, 0.5, 0.52, 0.6, 0.62], [0, 1, 1, 0.9, 0.9, 0])
    assert from_robot(clock(), braked, TIME[0] + 0.55).time - TIME[0] == pytest.approx(
        0.5, abs=0.01
    )
    with pytest.raises(RecordingError, match="loses no speed"):
        from_robot(clock(), time, None)
    with pytest.raises(RecordingError, match="5 rows are too few"):
        from_robot(clock(TIME[:5]), np.ones(5), None)


def test_friction_of_a_parabola():
    contact = float(TIME[0] + 0.5)
    found = measure_glide(clock(), pushed(1.5, friction=0.1), H, contact)
    assert not found.came_to_rest
    assert found.friction == pytest.approx(0.1, rel=1e-6)
    assert found.speed == pytest.approx(1.5 - 0.1 * 9.81 * found.time, rel=1e-5)
    assert found.direction_error == pytest.approx(0, abs=1e-3)


def test_direction_error_of_an_oblique_hit():
    oblique = np.array([0.6, -0.8, 0.0])
    position = pushed(1.0) @ H
    moved = (position - position[0])[:, None] * oblique + np.array([0.5, 0.9, 0.3])
    found = measure_glide(clock(), moved, H, float(TIME[0] + 0.5))
    assert found.direction_error == pytest.approx(np.degrees(np.arccos(0.8)), abs=1e-4)
    assert found.speed == pytest.approx(0.8)
