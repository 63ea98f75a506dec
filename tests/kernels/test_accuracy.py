"""Kernels against Pinocchio and central differences."""

import arms
import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hitjoints.errors import InputError, KernelMismatchError, ModelError
from hitjoints.kernels import Chain, build_kernel
from hitjoints.kernels.formulas.links import TracedArm
from hitjoints.kernels.formulas.mass_matrix import Factor, mass_matrix
from hitjoints.kernels.reference import PinocchioAnswers

OUTPUTS = ("inertia", "gradient", "position", "jacobian", "mobility_gradient", "response")
NAMED = {"iiwa14": arms.iiwa14, "iiwa7": arms.iiwa7, "panda": arms.panda, "xarm7": arms.xarm7}


def compare(model, contact, count, backend):
    q, h = arms.configurations(model, count), arms.directions(count)
    result = build_kernel(model, [contact], OUTPUTS, backend)(q, h)
    data = model.createData()
    reference = [PinocchioAnswers(model, data, q[i], contact, h[i]) for i in range(count)]
    inertia = 1.0 / np.array([r.mobility for r in reference])
    gradient = -(inertia[:, None] ** 2) * np.array([r.mobility_gradient for r in reference])
    size = np.maximum(inertia, np.abs(gradient).max(axis=1))
    assert np.abs(result["inertia"][0] / inertia - 1.0).max() <= 1e-11
    assert (np.abs(result["gradient"][0] - gradient).max(axis=1) / size).max() <= 1e-10
    for name in ("position", "jacobian"):
        expected = np.array([getattr(r, name) for r in reference])
        assert np.abs(result[name][0] - expected).max() <= 1e-13 * (1 + np.abs(expected).max())


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("name", NAMED)
@pytest.mark.parametrize("contact", [(5, (0.0, 0.0, 0.0)), (6, (0.03, -0.02, 0.1))])
def test_robots_agree_with_pinocchio(name, contact, backend):
    compare(NAMED[name](), contact, 1000, backend)


@pytest.mark.parametrize("seed", range(50))
def test_random_chains_agree_with_pinocchio(seed):
    model = arms.random_chain(seed)
    compare(model, (model.nv, (0.05, -0.03, 0.08)), 1000, ("llvm", "numpy")[seed % 2])


@pytest.mark.parametrize("seed", range(4))
def test_arms_of_one_joint_agree_with_pinocchio(seed):
    model = arms.random_chain(seed, 1)
    compare(model, (1, (0.05, -0.03, 0.08)), 100, ("llvm", "numpy")[seed % 2])


@settings(max_examples=40, deadline=None, derandomize=True)
@given(seed=st.integers(100, 10_000), joints=st.integers(1, 12), prismatic=st.floats(0.0, 1.0))
def test_normalising_and_regrouping_keep_the_mass_matrix(seed, joints, prismatic):
    model = arms.random_chain(seed, joints, prismatic)
    q = arms.configurations(model, 1, seed)[0]
    M = np.array(mass_matrix(TracedArm(Chain.from_model(model), tuple(q.tolist()))))
    expected = np.triu(pin.crba(model, model.createData(), q))
    assert np.abs(M - expected).max() <= 1e-13 * np.abs(expected).max()


def test_factor_reproduces_the_matrix():
    model = arms.random_chain(3, 6)
    q = arms.configurations(model, 1)[0]
    factor = Factor(mass_matrix(TracedArm(Chain.from_model(model), tuple(q.tolist()))))
    U = np.array(factor.U) + np.eye(6)
    M = np.triu(pin.crba(model, model.createData(), q))
    assert np.triu(U @ np.diag(1.0 / np.array(factor.inverse_D)) @ U.T) == pytest.approx(M)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_gradient_matches_central_differences(backend):
    model, step = arms.panda(), 6e-6
    kernel = build_kernel(model, [(7, (0.05, 0.0, 0.1))], ("inertia", "gradient"), backend)
    q, h = arms.configurations(model, 50), arms.directions(50)
    exact = kernel(q, h)
    for i in range(model.nv):
        shift = step * np.eye(model.nv)[i]
        ahead, behind = (kernel(q + s * shift, h)["inertia"][0] for s in (1.0, -1.0))
        size = 1.0 + np.abs(exact["inertia"][0]) ** 2
        assert np.all(
            np.abs((ahead - behind) / (2 * step) - exact["gradient"][0, :, i]) < 1e-7 * size
        )


def test_opposite_direction_gives_the_same_inertia():
    kernel = build_kernel(arms.iiwa14(), [(6, (0, 0, 0))])
    q, h = arms.configurations(arms.iiwa14(), 64), arms.directions(64)
    assert np.array_equal(kernel(q, h)["inertia"], kernel(q, -h)["inertia"])


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_infeasible_direction_gives_the_limits(backend):
    model = arms.iiwa14()
    outputs = ("inertia", "gradient", "speed", "straight_speed", "flux", "straight_flux")
    kernel = build_kernel(model, [(2, (0, 0, 0)), (7, (0, 0, 0))], outputs, backend)
    result = kernel(np.zeros((3, 7)), np.array([0.0, 0.0, 1.0]), mass=2.0)
    assert np.all(np.isinf(result["inertia"]))
    assert np.all(np.isnan(result["gradient"]))
    for name in outputs[2:]:
        assert np.all(result[name] == 0.0)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_large_angles_keep_their_accuracy(backend):
    model = arms.iiwa14()
    kernel = build_kernel(model, [(7, (0.1, 0, 0))], ("position",), backend)
    q = arms.configurations(model, 100)
    turned = q + 2.0 * np.pi * np.random.default_rng(1).integers(-20, 20, q.shape)
    h = np.array([1.0, 0.0, 0.0])
    assert kernel(turned, h)["position"] == pytest.approx(kernel(q, h)["position"], abs=1e-12)


def test_altered_constant_is_refused(monkeypatch):
    import dataclasses

    from hitjoints.kernels import kernel

    chain = Chain.from_model(arms.iiwa14())
    heavy = dataclasses.replace(chain.links[3], armature=0.01)
    wrong = dataclasses.replace(chain, links=(*chain.links[:3], heavy, *chain.links[4:]))
    monkeypatch.setattr(kernel.Chain, "from_model", lambda model: wrong)
    with pytest.raises(KernelMismatchError, match="inertia at joint 6"):
        build_kernel(arms.iiwa14(), [(6, (0, 0, 0))])


def test_wrong_velocity_limit_is_refused(monkeypatch):
    import dataclasses

    from hitjoints.kernels import kernel

    chain = Chain.from_model(arms.iiwa14())
    fast = dataclasses.replace(chain.links[1], slowest=-2.0, fastest=2.0)
    wrong = dataclasses.replace(chain, links=(chain.links[0], fast, *chain.links[2:]))
    monkeypatch.setattr(kernel.Chain, "from_model", lambda model: wrong)
    for output in ("speed", "straight_speed"):
        with pytest.raises(KernelMismatchError, match=output):
            build_kernel(arms.iiwa14(), [(6, (0, 0, 0))], (output,))


def test_unusable_models_are_refused():
    branch = pin.buildSampleModelManipulator()
    branch.addJoint(1, pin.JointModelRX(), pin.SE3.Random(), "branch")
    unbounded = pin.Model()
    unbounded.addJoint(0, pin.JointModelRUBX(), pin.SE3.Identity(), "endless")
    for model in (branch, unbounded, pin.Model(), arms.random_chain(0, 17)):
        with pytest.raises(ModelError):
            Chain.from_model(model)


def test_speed_without_limit_is_refused():
    model = arms.random_chain(1, 4)
    model.velocityLimit = np.full(4, np.finfo(float).max)
    build_kernel(model, [(4, (0.1, 0, 0))])
    with pytest.raises(InputError, match="velocity limit"):
        build_kernel(model, [(4, (0.1, 0, 0))], ("speed",))
