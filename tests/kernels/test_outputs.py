"""A new output is one line of the table, and none is served without what it is checked against."""

from operator import attrgetter

import arms
import numpy as np
import pytest

from hitjoints.errors import KernelMismatchError, UnknownNameError
from hitjoints.kernels import build_kernel
from hitjoints.kernels.outputs import OUTPUTS, Output

CONTACT = [(6, (0.0, 0.0, 0.05))]


def pull(hit):
    return list(hit.g)


def test_a_dummy_output_takes_one_line(monkeypatch):
    line = Output("pull", "n", pull, attrgetter("pull"), 1e-12, anywhere=True)
    monkeypatch.setitem(OUTPUTS, line.name, line)
    model = arms.iiwa14()
    result = build_kernel(model, CONTACT, ("pull", "jacobian"))(
        arms.configurations(model, 20), np.array([0.0, 0.6, 0.8])
    )
    expected = np.einsum("nij,i->nj", result["jacobian"][0], [0.0, 0.6, 0.8])
    np.testing.assert_allclose(result["pull"][0], expected, atol=1e-14)


def test_an_output_without_a_reference_is_refused(monkeypatch):
    monkeypatch.setitem(OUTPUTS, "pull", Output("pull", "n", pull, None, 1e-12))
    with pytest.raises(KernelMismatchError, match="pull has no reference"):
        build_kernel(arms.iiwa14(), CONTACT, ("inertia", "pull"))


def test_a_wrong_formula_is_refused(monkeypatch):
    wrong = Output("pull", "n", lambda hit: [2.0 * g for g in hit.g], attrgetter("pull"), 1e-12)
    monkeypatch.setitem(OUTPUTS, "pull", wrong)
    with pytest.raises(KernelMismatchError, match="pull at joint 6"):
        build_kernel(arms.iiwa14(), CONTACT, ("pull",))


def test_every_output_has_a_reference_and_is_compared():
    for output in OUTPUTS.values():
        assert output.reference is not None
        assert output.tolerance <= 1e-8
        assert output.samples >= 8
        assert output.formula.__doc__


def test_an_unknown_output_lists_the_choices():
    with pytest.raises(UnknownNameError, match=r"choose one of flux, gradient, inertia"):
        build_kernel(arms.iiwa14(), CONTACT, ("inertias",))
