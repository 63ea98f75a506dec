"""An arm whose meshes are missing: it hits as before, and what is not known is said."""

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.loading.load import load_robot
from hitjoints.show.viewer.solids import solids

HIT = ["--joint", "5", "--object=0.55,0.1,0.45", "--direction", "0,1,0", "--flux", "0.1"]


@pytest.fixture
def bare(tmp_path):
    """The iiwa 14 with meshes that are nowhere."""
    path = tmp_path / "arm.urdf"
    xml = load_robot("iiwa14").xml
    shape = '<geometry><mesh filename="package://lost/a.stl"/></geometry>'
    head, *parts = xml.split("<geometry>")
    rest = [part.split("</geometry>", 1)[1] for part in parts]
    path.write_text(head + "".join(shape + part for part in rest))
    return path


def test_drawn_with_bars(bare):
    drawn = solids(load_robot(bare))
    assert {one.name for one in drawn} <= {f"link_{i}" for i in range(8)}
    assert len(drawn) >= 4


def test_a_page_of_it_can_be_written(bare, run, tmp_path):
    pytest.importorskip("viser")
    told = run("view", "--robot", bare, "--out", tmp_path / "arm.html", "--json")
    assert told.code == 0, told.err
    assert "drawn with bars: a collision shape of" in told.err
    assert (tmp_path / "arm.html").stat().st_size > 1000


def test_simulated_as_with_its_meshes(bare, run):
    with_shapes = run("simulate", *HIT, "--json").json
    without = run("simulate", "--robot", bare, *HIT, "--json").json
    np.testing.assert_allclose(
        without["simulated"]["object_speed"], with_shapes["simulated"]["object_speed"], rtol=1e-6
    )


def test_every_dynamic_quantity_is_the_same(bare):
    lost, whole = load_robot(bare), load_robot("iiwa14")
    q = np.random.default_rng(0).uniform(-2, 2, (10, 7))
    for of in (hj.directional_inertia, hj.hitting_speed):
        np.testing.assert_array_equal(of(lost, q, 6, [0, 1, 0]), of(whole, q, 6, [0, 1, 0]))
