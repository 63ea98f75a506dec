"""One configuration, compiled: against Pinocchio, the batch kernels and the ordinary functions."""

import pickle
import threading

import numpy as np
import pytest

import hitjoints as hj
from hitjoints import evaluator as module
from hitjoints.dynamics.inertia import inertia_and_gradient_along
from hitjoints.kernels import build_kernel
from hitjoints.kernels.outputs import OUTPUTS
from hitjoints.model.robot import Contact

H = np.array([0.0, 0.6, 0.8])
ALL = tuple(OUTPUTS)


@pytest.fixture(scope="module")
def robot():
    return hj.load_robot("iiwa14")


@pytest.fixture(scope="module")
def evaluator(robot):
    return hj.Evaluator(robot, 6, ALL, mass=2.0)


def configurations(robot, count, seed=0):
    return np.random.default_rng(seed).uniform(robot.lower, robot.upper, (count, robot.n))


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7"])
def test_inertia_and_gradient_are_pinocchios(name):
    robot, contact = hj.load_robot(name), Contact(7, (0.02, -0.01, 0.1))
    evaluate = hj.Evaluator(robot, contact)
    for q in configurations(robot, 200):
        inertia, gradient = evaluate(q, 3.0 * H)
        expected, slope = inertia_and_gradient_along(robot, q, contact, H)
        assert inertia == pytest.approx(expected, rel=1e-12)
        np.testing.assert_allclose(gradient, slope, atol=1e-10 * max(expected, 1.0), rtol=1e-10)


def test_all_outputs_are_those_of_the_batch(robot, evaluator):
    rows = configurations(robot, 50, 1)
    kernel = build_kernel(robot.model, [(6, (0.0, 0.0, 0.0))], ALL)
    expected = kernel(rows, H, 2.0)
    for i, q in enumerate(rows):
        found = evaluator(q, H)
        assert found._fields == ALL
        for name in ALL:
            value, wanted = getattr(found, name), expected[name][0, i]
            assert np.shape(value) == np.shape(wanted)
            np.testing.assert_allclose(value, wanted, rtol=1e-10, atol=1e-11, err_msg=name)


def test_answers_are_the_callers_own(robot, evaluator):
    q = configurations(robot, 2, 2)
    first = evaluator(q[0], H)
    kept = first.gradient.copy()
    evaluator(q[1], H)
    np.testing.assert_array_equal(first.gradient, kept)
    first.gradient[:] = 0.0
    np.testing.assert_array_equal(evaluator(q[0], H).gradient, kept)


@pytest.mark.parametrize("length", [1e-200, 1e-140, 1e-3, 7.0, 1e140, 1e200])
def test_a_direction_has_any_length(robot, evaluator, length):
    q = configurations(robot, 1, 3)[0]
    expected = evaluator(q, H)
    for direction in (length * H, (length * H).tolist(), tuple(length * H)):
        found = evaluator(q, direction)
        assert found.inertia == pytest.approx(expected.inertia, rel=1e-13)
        assert found.straight_flux == pytest.approx(expected.straight_flux, rel=1e-12)
    assert evaluator(q.tolist(), H).inertia == expected.inertia


@pytest.mark.parametrize(
    ("q", "direction", "message"),
    [
        (np.zeros(6), H, "takes 7 joint positions"),
        (np.zeros((1, 7)), H, "one configuration is needed"),
        (np.full(7, np.nan), H, "must be finite"),
        ([0, 0, 0, np.inf, 0, 0, 0], H, "must be finite"),
        (np.zeros(7), np.zeros(3), "must not be zero"),
        (np.zeros(7), [0, np.nan, 1], "must be finite"),
        (np.zeros(7), [0.0, 1.0], "three numbers"),
        (np.zeros(7), np.ones((2, 3)), "one direction"),
        ("abc", H, "q ="),
        (np.zeros(7), "up", "direction ="),
    ],
)
def test_bad_input_is_named(evaluator, q, direction, message):
    with pytest.raises(hj.InputError, match=message):
        evaluator(q, direction)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((9,), "joints 1 to 7"),
        ((6, ("inertias",)), "choose one of"),
        ((6, ()), "at least one"),
        ((6, ("inertia", "inertia")), "each once"),
        ((6, ("flux",)), "needs the object's mass"),
        ((6, ("flux",), -1.0), "weighs more than 0 kg"),
    ],
)
def test_what_cannot_be_evaluated_is_refused(robot, arguments, message):
    with pytest.raises(hj.InputError, match=message):
        hj.Evaluator(robot, *arguments)


def test_a_direction_without_motion(robot):
    q = np.zeros(7)
    with pytest.raises(hj.InfeasibleError, match="joint 4 cannot move along"):
        hj.Evaluator(robot, 4, ("position", "inertia"))(q, [0.0, 0.0, 1.0])
    found = hj.Evaluator(robot, 4, ("speed", "straight_speed", "mobility"))(q, [0.0, 0.0, 1.0])
    assert found[:2] == (0.0, 0.0)
    assert found.mobility < 1e-16


def test_it_pickles(robot, evaluator):
    again, q = pickle.loads(pickle.dumps(evaluator)), configurations(robot, 1)[0]
    assert again(q, H).flux == evaluator(q, H).flux
    assert again(q, H)._fields == ALL


def test_threads_share_it(robot, evaluator):
    rows = configurations(robot, 300, 4)
    expected = [evaluator(q, H).gradient for q in rows]
    wrong = []

    def work():
        for q, want in zip(rows, expected, strict=True):
            if not np.array_equal(evaluator(q, H).gradient, want):
                wrong.append(q)

    threads = [threading.Thread(target=work) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


def test_without_llvm_the_answers_are_the_same(robot, evaluator, monkeypatch):
    monkeypatch.setenv("HITJOINTS_BACKEND", "numpy")
    slow = hj.Evaluator(robot, 6, ALL, mass=2.0)
    q = configurations(robot, 3, 5)
    for row in q:
        for a, b in zip(slow(row, H), evaluator(row, H), strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-11)
    with pytest.raises(hj.InfeasibleError):
        hj.Evaluator(robot, 4)(np.zeros(7), [0, 0, 1])
    with pytest.raises(hj.InputError, match="must be finite"):
        slow(np.full(7, np.nan), H)


FUNCTIONS = {
    "inertia": hj.directional_inertia,
    "gradient": hj.directional_inertia_gradient,
    "speed": hj.hitting_speed,
    "straight_speed": lambda *given: hj.hitting_speed(*given, straight=True),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_an_ordinary_function_is_compiled_when_it_is_asked_for_often(name, monkeypatch):
    monkeypatch.setattr(module, "WORTH_COMPILING", 20)
    robot, function = hj.load_robot("panda"), FUNCTIONS[name]
    rows = configurations(robot, 30, 6)
    before = [function(robot, q, 6, H) for q in rows[:19]]
    assert robot.kept[name, 6]._evaluator is None
    function(robot, rows[0], 6, H)
    assert robot.kept[name, 6]._evaluator is not None
    after = [function(robot, q, 6, H) for q in rows[:19]]
    np.testing.assert_allclose(after, before, rtol=1e-9, atol=1e-9)
    assert type(after[0]) is type(before[0])
    with pytest.raises(hj.InputError):
        function(robot, np.full(7, np.nan), 6, H)
    with pytest.raises(hj.InputError):
        function(robot, rows[0], 6, np.zeros(3))
    assert function(robot, rows, 6, H).shape[0] == 30
    assert pickle.loads(pickle.dumps(robot)).kept == {}


def test_few_calls_compile_nothing_and_new_contacts_are_not_kept_for_ever():
    robot = hj.load_robot("iiwa7")
    for i in range(200):
        contact = Contact(7, (0.0, 0.0, 1e-3 * i))
        hj.directional_inertia(robot, robot.home, contact, H)
    assert len(robot.kept) <= 64
    assert all(quick._evaluator is None for quick in robot.kept.values())
