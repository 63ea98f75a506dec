"""The formulas in C, compiled by the system's compiler, against the evaluator."""

import ctypes
import shutil
import subprocess

import numpy as np
import pytest

import hitjoints as hj
from hitjoints.errors import InputError

EVERYTHING = ("inertia", "gradient", "position", "jacobian", "speed", "straight_flux")
COMPILER = shutil.which("cc")
needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler here")


def compiled(text, folder, name="hit"):
    source, library = folder / "hit.c", folder / "hit.so"
    source.write_text(text)
    flags = ["-std=c99", "-pedantic", "-Wall", "-Werror", "-O1", "-shared", "-fPIC"]
    subprocess.run([COMPILER, *flags, "-o", library, source, "-lm"], check=True)
    function = ctypes.CDLL(str(library))[name]
    double = np.ctypeslib.ndpointer(dtype=float, flags="C_CONTIGUOUS")
    function.argtypes, function.restype = [double, double], None
    return function


@needs_compiler
@pytest.mark.parametrize(("name", "joint"), [("iiwa14", 6), ("panda", 7)])
def test_it_gives_the_numbers_of_the_evaluator(name, joint, tmp_path):
    robot, rng = hj.load_robot(name), np.random.default_rng(0)
    contact = hj.Contact(joint, (0.0, 0.02, 0.05))
    function = compiled(hj.c_source(robot, contact, EVERYTHING), tmp_path)
    evaluate = hj.Evaluator(robot, contact, EVERYTHING, mass=2.0)
    out = np.zeros(1 + sum(np.size(v) for v in evaluate(robot.home, [0.0, 1.0, 0.0])))
    for _ in range(200):
        q, h = rng.uniform(robot.lower, robot.upper), 3.0 * rng.normal(size=3)
        function(np.array([*q, *h, 2.0]), out)
        expected = np.concatenate([np.ravel(value) for value in evaluate(q, h)])
        assert out[0] == 2.0
        np.testing.assert_allclose(out[1:], expected, rtol=1e-10, atol=1e-10)


@needs_compiler
def test_the_status_tells_what_cannot_be_answered(tmp_path):
    robot = hj.load_robot("iiwa14")
    function = compiled(hj.c_source(robot, 1, ("inertia", "speed"), "first"), tmp_path, "first")
    out = np.zeros(3)
    function(np.array([*robot.home, 0.0, 1.0, 0.0, 1.0]), out)
    assert out[0] == 1.0  # a point on the first axis cannot move
    assert out[1] == np.inf
    assert out[2] == 0.0
    for bad in ([*robot.home, 0.0, 0.0, 0.0, 1.0], [np.nan, *robot.home[1:], 0.0, 1.0, 0.0, 1.0]):
        function(np.array(bad), out)
        assert out[0] == 0.0


def test_what_cannot_be_written_is_refused():
    robot = hj.load_robot("iiwa14")
    for arguments, words in (
        ({"name": "2fast"}, "name"),
        ({"name": "while"}, "name"),
        ({"name": "hit;"}, "name"),
        ({"outputs": ()}, "outputs"),
        ({"outputs": ("weight",)}, "outputs"),
        ({"contact": 9}, "joint"),
    ):
        with pytest.raises(InputError, match=words):
            hj.c_source(**{"robot": robot, "contact": 6} | arguments)


def test_the_command_writes_it(run, tmp_path):
    out = tmp_path / "hit.c"
    done = run("export", "c", "--joint", "6", "--output", "inertia", "--name", "felt", "--out", out)
    assert done.code == 0, done.err
    assert "void felt(const double *in, double *out)" in out.read_text()
    shown = run("export", "c", "--joint", "6", "--output", "inertia", "--name", "felt")
    assert shown.out == out.read_text()
    assert run("export", "c", "--out", tmp_path / "hit.txt").code == 1
