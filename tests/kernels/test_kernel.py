"""Back ends, threads and the border of the batch kernels."""

import sys

import arms
import numpy as np
import pytest

from hitjoints.errors import InputError
from hitjoints.kernels import build_kernel
from hitjoints.kernels.outputs import OUTPUTS
from hitjoints.kernels.tape import backends

H = np.array([0.0, 1.0, 0.0])
CONTACTS = [(5, (0, 0, 0)), (6, (0.02, 0, 0)), (7, (0, 0, 0.1))]


@pytest.mark.parametrize("shared", [True, False])
@pytest.mark.parametrize("make", [arms.iiwa14, arms.xarm7])
def test_backends_agree(make, shared):
    q = arms.configurations(make(), 3001)
    h = H if shared else arms.directions(3001)
    llvm, plain = (
        build_kernel(make(), CONTACTS, tuple(OUTPUTS), name)(q, h, 2.0)
        for name in ("llvm", "numpy")
    )
    for name, values in llvm.items():
        scale = np.maximum(
            1.0, np.abs(plain[name]).max(axis=tuple(range(2, values.ndim)), keepdims=True)
        )
        feasible = plain["mobility"] > 1e-6
        deviation = (np.abs(values - plain[name]) / scale)[feasible]
        assert deviation.max() < 1e-8, name


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_threads_and_splits_do_not_change_a_bit(backend):
    kernel = build_kernel(arms.iiwa14(), CONTACTS, ("inertia", "gradient", "speed"), backend)
    q = arms.configurations(arms.iiwa14(), 20_011)
    whole = kernel(q, H, threads=1)
    for threads in (2, 3, 7, None):
        again = kernel(q, H, threads=threads)
        assert all(np.array_equal(whole[name], again[name]) for name in whole)
    cut = [kernel(part, H)["gradient"] for part in (q[:5], q[5:4103], q[4103:])]
    assert np.array_equal(np.concatenate(cut, axis=1), whole["gradient"])


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("rows", [0, 1, 2, 7, 8, 9, 65])
def test_any_number_of_rows(backend, rows):
    kernel = build_kernel(arms.iiwa14(), CONTACTS, ("inertia", "jacobian"), backend)
    q = arms.configurations(arms.iiwa14(), 65)
    result, whole = kernel(q[:rows], H), kernel(q, H)
    assert result["jacobian"].shape == (3, rows, 3, 7)
    assert np.array_equal(result["inertia"], whole["inertia"][:, :rows])


def test_layout_of_the_input_does_not_matter():
    kernel = build_kernel(arms.iiwa14(), CONTACTS)
    q = arms.configurations(arms.iiwa14(), 100)
    expected = kernel(q, H)["inertia"]
    assert np.array_equal(kernel(np.asfortranarray(q), H)["inertia"], expected)
    assert np.array_equal(kernel(np.repeat(q, 2, axis=0)[::2], H)["inertia"], expected)


def test_unknown_names_list_the_choices(monkeypatch):
    with pytest.raises(InputError, match="llvm, numpy"):
        build_kernel(arms.iiwa14(), CONTACTS, backend="cuda")
    with pytest.raises(InputError, match="inertia, jacobian"):
        build_kernel(arms.iiwa14(), CONTACTS, ("mass",))
    monkeypatch.setenv("HITJOINTS_BACKEND", "gpu")
    with pytest.raises(InputError, match="HITJOINTS_BACKEND"):
        build_kernel(arms.iiwa14(), CONTACTS)


def test_environment_chooses_the_backend(monkeypatch):
    monkeypatch.setenv("HITJOINTS_BACKEND", "numpy")
    assert backends.choose() == "numpy"
    assert backends.choose("llvm") == "llvm"


def test_without_llvm_numpy_serves(monkeypatch):
    monkeypatch.delenv("HITJOINTS_BACKEND", raising=False)
    monkeypatch.setitem(sys.modules, "llvmlite", None)
    monkeypatch.setitem(sys.modules, "llvmlite.binding", None)
    monkeypatch.delitem(sys.modules, "hitjoints.kernels.tape.llvm_backend", raising=False)
    backends.llvm_works.cache_clear()
    try:
        assert backends.choose() == "numpy"
        q = arms.configurations(arms.iiwa14(), 10)
        assert np.isfinite(build_kernel(arms.iiwa14(), CONTACTS)(q, H)["inertia"]).all()
    finally:
        backends.llvm_works.cache_clear()


@pytest.mark.parametrize(
    ("q", "direction", "mass", "argument"),
    [
        (np.zeros((4, 6)), H, 1.0, "q"),
        (np.zeros(7), H, 1.0, "q"),
        (np.zeros((4, 7)), np.zeros((5, 3)), 1.0, "direction"),
        (np.zeros((4, 7)), H, None, "mass"),
        (np.zeros((4, 7)), H, np.ones(3), "mass"),
    ],
)
def test_wrong_input_names_the_argument(q, direction, mass, argument):
    kernel = build_kernel(arms.iiwa14(), CONTACTS, ("flux",))
    with pytest.raises(InputError) as caught:
        kernel(q, direction, mass)
    assert caught.value.argument == argument


def test_wrong_contacts_and_threads_are_refused():
    for contact in ((0, (0, 0, 0)), (8, (0, 0, 0)), (7, (0, 0)), (7, (0, np.nan, 0))):
        with pytest.raises(InputError):
            build_kernel(arms.iiwa14(), [contact])
    with pytest.raises(InputError, match="at least one"):
        build_kernel(arms.iiwa14(), [])
    with pytest.raises(InputError, match="threads"):
        build_kernel(arms.iiwa14(), CONTACTS)(np.zeros((9, 7)), H, threads=0)


@pytest.mark.parametrize("lanes", [1, 2, 4])
def test_narrower_vectors_give_the_same_numbers(monkeypatch, lanes):
    """What processors without AVX-512 run."""
    from hitjoints.kernels.tape import llvm_backend

    model, outputs = arms.iiwa14(), ("inertia", "gradient", "straight_speed")
    q, h = arms.configurations(model, 37), arms.directions(37)
    wide = build_kernel(model, [(6, (0.0, 0.0, 0.1))], outputs, "llvm")(q, h)
    monkeypatch.setattr(llvm_backend, "host_lanes", lambda: lanes)
    kernel = build_kernel(model, [(6, (0.0, 0.0, 0.1))], outputs, "llvm")
    assert kernel.runnable.lanes == lanes
    narrow = kernel(q, h)
    for name in outputs:
        scale = np.abs(wide[name]).max()
        assert np.abs(narrow[name] - wide[name]).max() <= 1e-12 * scale
