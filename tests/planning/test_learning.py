from __future__ import annotations

import json
import sys

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.built import kernel_for
from hitjoints.dynamics.kinematics import position
from hitjoints.errors import InfeasibleError, InputError, MissingExtraError
from hitjoints.model.robot import Contact
from hitjoints.planning.learning.feasibility import learn_feasibility, load_feasibility
from hitjoints.planning.learning.greatest_flux import maximum_flux, random_positions
from hitjoints.quantities import place_joint
from hitjoints.vectors import unit

SMALL = {"positions": 800, "directions": 4, "samples": 48}
MASS, JOINT = 2.0, Contact(6)


@pytest.fixture(scope="module")
def robot(arm):
    pytest.importorskip("sklearn")
    return arm("iiwa14")


@pytest.fixture(scope="module")
def learnt(robot):
    return learn_feasibility(robot, 6, MASS, **SMALL)


@pytest.fixture(scope="module")
def held_out(robot):
    """Positions, directions, and the exact answer: the greatest flux of dense samples."""
    rng = np.random.default_rng(77)
    at = random_positions(robot, JOINT, 150, rng)
    h = unit(rng.normal(size=(150, 3)))
    return at, h, maximum_flux(robot, JOINT, MASS, at, h, 512, 5)[0]


def test_the_probability_answers_the_exact_question(learnt, held_out):
    at, h, greatest = held_out
    asked = np.random.default_rng(1).uniform(0.1, 1.5, len(at))
    found, truth = learnt.probability(at, h, asked), greatest >= asked
    assert found.shape == (150,)
    assert ((found >= 0) & (found <= 1)).all()
    assert np.mean((found > 0.5) == truth) > 0.88
    guess = truth.mean()
    assert np.mean((found - truth) ** 2) < 0.4 * guess * (1 - guess)


def test_the_probability_falls_with_flux(learnt, held_out):
    at, h, _ = held_out
    asked = np.linspace(0.0, 6.0, 301)
    each = np.array([learnt.probability(at, h, flux) for flux in asked])
    assert (np.diff(each, axis=0) <= 0).all()
    assert each[0].max() > 0.99


def test_out_of_reach_and_out_of_power(learnt):
    assert learnt.probability([2.0, 0.0, 0.5], [0, 1, 0], 0.3) < 0.05
    assert learnt.probability([0.5, 0.0, 0.5], [0, 1, 0], 5.0) < 0.05
    assert learnt.probability([0.5, 0.0, 0.5], [0, 1, 0], 0.2) > 0.95


def test_the_answer_does_not_depend_on_the_side_of_the_arm(learnt):
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    at, h = np.array([0.5, 0.1, 0.5]), np.array([0.3, 0.9, 0.1])
    here = learnt.probability(at, h, 1.0)
    assert isinstance(here, float)
    assert learnt.probability(turn @ at, turn @ h, 1.0) == pytest.approx(here, abs=1e-9)


def test_fluxes_broadcast(learnt):
    many = learnt.probability(np.tile([0.5, 0.1, 0.5], (3, 1)), [0, 1, 0], [0.2, 1.0, 4.0])
    each = [learnt.probability([0.5, 0.1, 0.5], [0, 1, 0], flux) for flux in (0.2, 1.0, 4.0)]
    np.testing.assert_allclose(many, each)


def test_proposals_are_valid_and_better_than_random(robot, learnt, held_out):
    kernel = kernel_for(robot, (JOINT,), ("flux",))
    shares = {"learnt": [], "random": []}
    for at, h, greatest in zip(*held_out, strict=True):
        q = learnt.propose(at, h, 4)
        if not greatest:
            assert q.shape == (0, 7)
            continue
        assert ((q >= robot.lower) & (q <= robot.upper)).all()
        assert all(np.linalg.norm(position(robot, row, 6) - at) < 1e-8 for row in q)
        drawn = place_joint(robot, 6, np.tile(at, (4, 1)), 9)
        for name, rows in (("learnt", q), ("random", drawn.q[drawn.solved])):
            best = kernel(rows, h, MASS)["flux"][0].max() if len(rows) else 0.0
            shares[name].append(best / greatest)
    assert np.median(shares["learnt"]) > 0.97
    assert np.median(shares["learnt"]) > np.median(shares["random"]) + 0.01


def test_same_seed_same_result(robot, learnt):
    again = learn_feasibility(robot, 6, MASS, **SMALL)
    np.testing.assert_array_equal(again.q, learnt.q)
    for one, other in zip(again.layers, learnt.layers, strict=True):
        np.testing.assert_array_equal(one, other)


def test_it_is_stored_without_pickle_and_with_its_origin(robot, learnt, tmp_path):
    path = tmp_path / "joint_6.npz"
    learnt.save(path)
    with np.load(path, allow_pickle=False) as file:
        attributes = json.loads(str(file["attributes"]))
    assert attributes["digest"] == robot.digest
    assert attributes["provenance"]["seed"] == 0
    assert attributes["provenance"]["positions"] == 800
    again = load_feasibility(path, robot)
    question = [0.4, 0.3, 0.6], [0.0, 1.0, 0.2]
    assert again.probability(*question, 0.9) == learnt.probability(*question, 0.9)
    np.testing.assert_array_equal(again.propose(*question), learnt.propose(*question))
    assert (again.contact, again.mass) == (JOINT, MASS)


def test_files_that_do_not_fit_are_refused(arm, learnt, tmp_path):
    path = tmp_path / "joint_6.npz"
    learnt.save(path)
    with pytest.raises(InputError, match="another robot than iiwa7"):
        load_feasibility(path, arm("iiwa7"))
    for name, content in (("text.npz", b"no archive"), ("cut.npz", path.read_bytes()[:2000])):
        (tmp_path / name).write_bytes(content)
        with pytest.raises(InputError, match="learnt feasibility"):
            load_feasibility(tmp_path / name, arm("iiwa14"))
    np.savez(tmp_path / "other.npz", x=np.zeros(3))
    for name in ("other.npz", "missing.npz"):
        with pytest.raises(InputError, match="learnt feasibility"):
            load_feasibility(tmp_path / name, arm("iiwa14"))
    with pytest.raises(InputError, match=r"\.npz"):
        learnt.save(tmp_path / "joint_6.pickle")


def test_a_small_arm_without_symmetry(urdf):
    pytest.importorskip("sklearn")
    robot = urdf.load(urdf.two_links())  # its first joint stands beside the base's origin
    tip = Contact(2, (0.3, 0.0, 0.0))
    # Few random positions lie in the plane the arm moves in; those of configurations all do.
    learnt = learn_feasibility(robot, tip, 1.0, positions=300, directions=4, samples=8)
    assert learnt.hits.shape[1] == 6
    assert learnt.propose(position(robot, [0.3, -0.6], tip), [0, 1, 0], 2).shape == (2, 2)


def test_contacts_that_never_hit(robot, urdf):
    with pytest.raises(InputError, match="no joint moves this contact"):
        learn_feasibility(robot, 1, MASS, **SMALL)
    locked = urdf.load(urdf.two_links().replace('velocity="2"', 'velocity="0"'))
    with pytest.raises(InfeasibleError, match="joint 2 of small cannot produce any flux"):
        learn_feasibility(locked, 2, MASS, positions=20, directions=1, samples=2)


def test_without_scikit_learn(arm, monkeypatch):
    monkeypatch.setitem(sys.modules, "sklearn", None)
    monkeypatch.setitem(sys.modules, "sklearn.neural_network", None)
    with pytest.raises(MissingExtraError, match=r"hitjoints\[learn\]"):
        learn_feasibility(arm("iiwa14"), 6, MASS)


@pytest.mark.parametrize(
    ("argument", "call"),
    [
        ("flux", lambda f: f.probability([0.5, 0, 0.5], [0, 1, 0], np.nan)),
        ("flux", lambda f: f.probability(np.ones((2, 3)), [0, 1, 0], [0.1, 0.2, 0.3])),
        ("position", lambda f: f.probability([0.5, 0], [0, 1, 0], 0.5)),
        ("direction", lambda f: f.propose([0.5, 0, 0.5], [0, 0, 0])),
        ("count", lambda f: f.propose([0.5, 0, 0.5], [0, 1, 0], 0)),
        ("position", lambda f: f.propose(np.ones((2, 3)), [0, 1, 0])),
        ("samples", lambda f: learn_feasibility(f.robot, 6, MASS, samples=0)),
        ("positions", lambda f: learn_feasibility(f.robot, 6, MASS, positions=3)),
        ("joint", lambda f: learn_feasibility(f.robot, 9, MASS)),
    ],
)
def test_bad_arguments_are_named(learnt, argument, call):
    with pytest.raises(InputError) as caught:
        call(learnt)
    assert caught.value.argument == argument


@pytest.fixture(scope="module")
def map_of_motions(robot):
    around = np.linspace(-0.7, 0.7, 9)
    h = [[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.6, 0.8]]
    return hj.sweep_motion(
        robot, around, around, [0.3, 0.5, 0.7], h, MASS, joints=[6], samples=20, tries=2
    )


def test_what_motions_deliver_is_learnt_from_a_map_of_them(robot, map_of_motions):
    learnt = learn_feasibility(robot, 6, MASS, swept=map_of_motions)
    part = map_of_motions.isel(joint=0)
    axes = np.meshgrid(part.x, part.y, part.z, indexing="ij")
    at = np.stack([axis.ravel() for axis in axes], axis=1)
    right, sure, rng = [], [], np.random.default_rng(2)
    for d, h in enumerate(part.direction_vector.values):
        flux = np.nan_to_num(part.flux.isel(direction=d).values.ravel())
        asked = rng.uniform(0.05, 1.0, flux.size)
        found = learnt.probability(at, np.tile(h, (len(at), 1)), asked)
        right += [(found > 0.5) == (flux >= asked)]
        sure += [flux >= asked]
    assert np.mean(right) > 0.85
    assert 0.15 < np.mean(sure) < 0.6  # neither answer alone would do
    place, h = np.array([0.5, 0.1, 0.5]), np.array([0.0, 1.0, 0.0])
    proposed = learnt.propose(place, h, 3)
    assert len(proposed)
    for q in proposed:
        np.testing.assert_allclose(hj.position(robot, q, 6), place, atol=1e-8)
    assert learnt.provenance["hits"] == 9 * 9 * 3 * 3
    again = learn_feasibility(robot, 6, MASS, swept=map_of_motions)
    np.testing.assert_array_equal(again.layers[0], learnt.layers[0])


def test_maps_that_do_not_fit_are_refused(robot, arm, map_of_motions):
    for given, words in (
        ((robot, 7, MASS), "joint 7"),
        ((robot, 6, 2.5), "mass"),
        ((arm("iiwa7"), 6, MASS), "robot"),
    ):
        with pytest.raises(InputError, match=words):
            learn_feasibility(*given, swept=map_of_motions)
    with pytest.raises(InputError, match="a map over object positions"):
        learn_feasibility(robot, 6, MASS, swept=map_of_motions.drop_attrs())
