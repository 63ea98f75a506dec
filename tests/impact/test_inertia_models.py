"""The inertia that an arm shows by each model of its drives."""

import numpy as np
import pinocchio as pin
import pytest

import hitjoints as hj
from hitjoints.impact.rotor import with_rotors
from hitjoints.kernels.formulas.chain import Chain
from hitjoints.kernels.outputs import record

H = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module", params=["iiwa14", "panda"])
def arm(request):
    return hj.load_robot(request.param)


def some(robot, count, seed=3):
    random = np.random.default_rng(seed)
    h = random.normal(size=(count, 3))
    return random.uniform(*robot.finite_limits, (count, robot.n)), h


def test_rotors_are_on_the_diagonal_of_the_mass_matrix(arm):
    q, h = some(arm, 30)
    batch = hj.impact_inertia(arm, q, 6, h, "rotor")
    h /= np.linalg.norm(h, axis=1, keepdims=True)
    for row, along, value in zip(q, h, batch, strict=True):
        M = pin.crba(arm.model, arm.model.createData(), row)
        g = hj.jacobian(arm, row, 6).T @ along
        expected = 1 / (g @ np.linalg.solve(M + np.diag(arm.rotor_inertia), g))
        assert hj.impact_inertia(arm, row, 6, along, "rotor") == pytest.approx(expected, rel=1e-12)
        assert value == pytest.approx(expected, rel=1e-12)


def test_rigid_is_the_directional_inertia_to_the_last_bit(arm):
    q, h = some(arm, 20)
    one = hj.directional_inertia(arm, q, 7, h)
    assert (hj.impact_inertia(arm, q, 7, h) == one).all()
    assert (hj.impact_inertia(arm, q, 7, h, "rotor", rotor_inertia=0.0) == one).all()


@pytest.mark.parametrize("model", ["rotor", "composite"])
@pytest.mark.parametrize("contact", [7, hj.Contact(4, (0.05, -0.1, 0.02))])
def test_gradient_by_central_differences(arm, model, contact):
    q, h = some(arm, 20)
    batch = hj.impact_inertia_gradient(arm, q, contact, h, model)
    step = 1e-3
    for row, along, gradient in zip(q, h, batch, strict=True):
        single = hj.impact_inertia_gradient(arm, row, contact, along, model)
        np.testing.assert_allclose(single, gradient, rtol=1e-9, atol=1e-9)
        for i in range(arm.n):
            aside = row + step * np.outer((-3, -2, -1, 1, 2, 3), np.eye(arm.n)[i])
            rows = hj.impact_inertia(arm, aside, contact, along, model)
            slope = np.array([-1, 9, -45, 45, -9, 1]) @ rows / (60 * step)
            assert slope == pytest.approx(gradient[i], abs=1e-8 * max(1.0, np.abs(gradient).max()))


def test_composite_is_the_sum_over_the_bodies(arm):
    q, h = some(arm, 30)
    contact = hj.Contact(5, (0.03, -0.02, 0.07))
    batch = hj.impact_inertia(arm, q, contact, h, "composite")
    for row, along, value in zip(q, h, batch, strict=True):
        data = arm.model.createData()
        pin.forwardKinematics(arm.model, data, row)
        place = data.oMi[5].act(np.array(contact.offset))
        # Every link as six numbers about the world's origin: mass, first and second moments.
        total, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
        for pose, link in zip(data.oMi.tolist()[1:], arm.model.inertias.tolist()[1:], strict=True):
            centre = pose.act(link.lever)
            about = pose.rotation @ link.inertia @ pose.rotation.T
            total, first = total + link.mass, first + link.mass * centre
            second += about + link.mass * (centre @ centre * np.eye(3) - np.outer(centre, centre))
        middle = first / total
        second -= total * (middle @ middle * np.eye(3) - np.outer(middle, middle))
        unit = along / np.linalg.norm(along)
        twist = np.cross(place - middle, unit)
        expected = 1 / (1 / total + twist @ np.linalg.solve(second, twist))
        assert value == pytest.approx(expected, rel=1e-12)
        single = hj.impact_inertia(arm, row, contact, along, "composite")
        assert single == pytest.approx(value, rel=1e-13)


def test_rotors_only_add_inertia_and_locked_joints_at_most_the_mass(arm):
    q, h = some(arm, 200)
    rigid = hj.impact_inertia(arm, q, 7, h)
    assert (hj.impact_inertia(arm, q, 7, h, "rotor") > rigid).all()
    total = sum(link.mass for link in arm.model.inertias.tolist()[1:])
    locked = hj.impact_inertia(arm, q, 7, h, "composite")
    assert (locked <= total * (1 + 1e-12)).all()
    assert (locked >= rigid * (1 - 1e-9)).sum() > 190  # fixed to the floor, an arm may show more


def test_known_medians_of_the_iiwa():
    arm = hj.load_robot("iiwa14")
    q = np.random.default_rng(0).uniform(arm.lower, arm.upper, (2000, 7))
    for joint, expected in ((7, (1.8, 15.1, 5.4)), (6, (4.3, 18.4, 6.2)), (5, (10.6, 38.8, 10.8))):
        found = [
            np.median(hj.impact_inertia(arm, q, joint, H, model))
            for model in ("rigid", "rotor", "composite")
        ]
        np.testing.assert_allclose(found, expected, rtol=0.05)


def test_what_is_not_known_is_said():
    arm = hj.load_robot("xarm7")
    with pytest.raises(hj.ModelError, match=r"rotor_inertia .* to its TOML.*--rotor-inertia"):
        hj.impact_inertia(arm, arm.home, 5, H, "rotor")
    assert hj.impact_inertia(arm, arm.home, 5, H, "rotor", rotor_inertia=0.1) > 0
    with pytest.raises(hj.InputError, match="choose one of composite, rigid, rotor"):
        hj.impact_inertia(arm, arm.home, 5, H, "rotors")
    for wrong in (-1.0, np.nan, [1.0, 2.0], "heavy"):
        with pytest.raises(hj.InputError, match="rotor_inertia"):
            hj.impact_inertia(arm, arm.home, 5, H, "rotor", rotor_inertia=wrong)


def test_rotors_cost_the_kernels_next_to_nothing(arm):
    operations = []
    for robot in (arm, with_rotors(arm)):
        chain = Chain.from_model(robot.model)
        program = record(chain, [chain.attach(7, (0.0, 0.0, 0.1))], ("inertia", "gradient"))
        operations.append(program.count)
    assert operations[1] <= 1.02 * operations[0]
