"""Every number that was read is the number in the model, or loading says so."""

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.errors import ModelError
from hitjoints.loading.load import load_robot, read_arm
from hitjoints.loading.source import describe
from hitjoints.model.compare import compare_model
from hitjoints.model.tree import roll_pitch_yaw, rotation, turn_about

ODD = {"space": "1.25 ", "tab": "\t1.25", "underscore": "1.2_5", "plus": "+1.25",
       "full width": "\uff11.\uff12\uff15", "exponent": "125e-2"}  # fmt: skip


def numbers(robot):
    model = robot.model
    bodies = [[i.mass, *i.lever, *i.inertia.ravel()] for i in model.inertias]
    places = [p.homogeneous.ravel() for p in model.jointPlacements]
    limits = (robot.lower, robot.upper, robot.velocity_upper, robot.effort)
    matrix = pin.crba(model, model.createData(), robot.home + 0.1)
    return [np.array(bodies), np.array(places), *limits, matrix]


@pytest.mark.parametrize("odd", ODD.values(), ids=ODD)
@pytest.mark.parametrize("place", ["mass", "tensor", "centre", "origin", "axis", "limit", "speed"])
def test_numbers_are_read_alike_however_they_are_written(urdf, odd, place):
    def build(word):
        def one(name, plain):
            return word if place == name else plain

        sides = f'upper="{one("limit", 1.5)}" velocity="{one("speed", 2)}"'
        limit = f'<limit lower="-2" {sides} effort="3"/>'
        return urdf.load(
            urdf.base,
            urdf.link("link_1", mass=2),
            urdf.link(
                "link_2",
                mass=one("mass", 1),
                com=(one("centre", 0.1), 0, 0.2),
                moments=(one("tensor", 1.5), 1.5, 1.5),
            ),
            urdf.joint("joint_1", "base", "link_1"),
            urdf.joint(
                "joint_2", "link_1", "link_2", at=f"{one('origin', 0.3)} 0 0",
                axis=f"{one('axis', 0)} 0 1", more=limit,
            ),
        )  # fmt: skip

    for found, expected in zip(numbers(build(odd)), numbers(build("1.25")), strict=True):
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("wrong", ["", " ", "1,25", "1.2.5", "0x1p3", "1e400", "nan", "one", "1 2"])
def test_what_is_no_number_is_refused_by_name(urdf, wrong):
    with pytest.raises(ModelError, match=r"link link_2: inertial mass value = .* finite number"):
        urdf.load(
            urdf.base,
            urdf.link("link_1"),
            urdf.link("link_2", mass=wrong),
            urdf.joint("joint_1", "base", "link_1"),
            urdf.joint("joint_2", "link_1", "link_2"),
        )


def spoil_mass(model):
    model.inertias[2].mass *= 1 + 1e-6


def spoil_centre(model):
    model.inertias[2].lever += np.array([0, 1e-6, 0])


def spoil_tensor(model):
    model.inertias[1].inertia = model.inertias[1].inertia + 1e-6 * np.eye(3)


def spoil_place(model):
    model.jointPlacements[2].translation = model.jointPlacements[2].translation + 1e-6


def spoil_limit(model):
    model.upperPositionLimit[1] += 1e-6


def spoil_effort(model):
    model.upperEffortLimit[0] *= 1 + 1e-6


def spoil_speed(model):
    model.upperVelocityLimit[0] *= 1 + 1e-6


SPOILT = {
    spoil_mass: "joint_2: the mass it carries",
    spoil_centre: "joint_2: the mass centre it carries",
    spoil_tensor: "joint_1: the tensor it carries",
    spoil_place: "joint_2: its place",
    spoil_limit: "joint_2: upper limit",
    spoil_effort: "joint_1: effort limit",
    spoil_speed: "joint_1: velocity limit",
}


@pytest.mark.parametrize("spoil", SPOILT)
def test_a_difference_between_text_and_model_is_an_error(urdf, spoil):
    tool = urdf.link("tool", mass=0.2) + urdf.joint(
        "mount", "link_2", "tool", "fixed", at="0 .1 .2", rpy="1 2 3"
    )
    xml = urdf.two_links(rpy="0.4 0.5 0.6", axis="1 2 -3").replace("</robot>", tool + "</robot>")
    arm = read_arm(describe(urdf.write(xml)))
    model = pin.buildModelFromXML(arm.xml)
    compare_model(model, arm, "small")
    spoil(model)
    with pytest.raises(ModelError, match=SPOILT[spoil]):
        compare_model(model, arm, "small")


@pytest.mark.parametrize("name", ["iiwa14", "panda", "kinova", "tiago", "z1", "so100"])
def test_real_arms_are_read_back(name):
    load_robot(name)  # compares on its way


@pytest.mark.parametrize("pitch", [0.0, 0.3, -1.2, np.pi / 2, -np.pi / 2, np.pi / 2 - 1e-9, np.pi])
def test_angles_of_a_rotation_are_exact_at_the_poles_too(pitch):
    rng = np.random.default_rng(0)
    for roll, yaw in rng.uniform(-np.pi, np.pi, (50, 2)):
        turn = rotation(np.array([roll, pitch, yaw]))
        np.testing.assert_allclose(rotation(roll_pitch_yaw(turn)), turn, rtol=0, atol=2e-15)
        expected = pin.rpy.rpyToMatrix(np.array([roll, pitch, yaw]))
        np.testing.assert_allclose(turn, expected, rtol=0, atol=2e-15)
    axis = rng.normal(size=3)
    expected = pin.exp3(pitch * axis / np.linalg.norm(axis))
    np.testing.assert_allclose(turn_about(axis, pitch), expected, rtol=0, atol=2e-15)


def test_load_time_stays_small(arm):
    import time

    arm("iiwa14")
    spent = []
    for _ in range(5):
        start = time.process_time()
        load_robot("ur5_robot")
        spent.append(time.process_time() - start)
    assert min(spent) < 0.02
