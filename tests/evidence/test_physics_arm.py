"""The arm in MuJoCo is the arm in Pinocchio: mass matrix, positions, forces."""

import sys

import mujoco
import numpy as np
import pinocchio as pin
import pytest

from hitjoints.errors import MissingExtraError, ModelError
from hitjoints.evidence.physics.engine_arm import arm_spec, link_name
from hitjoints.evidence.physics.engine_scene import build_scene
from hitjoints.evidence.physics.first_touch import ImpactState
from hitjoints.evidence.physics.setting import EngineSetting
from hitjoints.loading.load import load_robot
from hitjoints.model.robot import Contact


def judge(robot, *, close=1e-10):
    model = arm_spec(robot).compile()
    data, rng = mujoco.MjData(model), np.random.default_rng(0)
    assert (model.nq, model.nv) == (robot.n, robot.n)
    for _ in range(20):
        q, qd = rng.uniform(-2, 2, (2, robot.n))
        data.qpos[:], data.qvel[:] = q, qd
        mujoco.mj_forward(model, data)
        M = np.column_stack([times_mass(model, data, column) for column in np.eye(robot.n)])
        np.testing.assert_allclose(M, pin.crba(robot.model, robot.data, q), rtol=0, atol=close)
        # Coriolis, centrifugal and gravity forces; the compensation of gravity takes its part off.
        bias = pin.nonLinearEffects(robot.model, robot.data, q, qd)
        np.testing.assert_allclose(data.qfrc_bias, bias, rtol=0, atol=close)
        weight = pin.computeGeneralizedGravity(robot.model, robot.data, q)
        np.testing.assert_allclose(data.qfrc_gravcomp, weight, rtol=0, atol=close)
        np.testing.assert_allclose(
            data.qacc, np.linalg.solve(M, weight - bias), rtol=1e-6, atol=1e-6
        )
        pin.forwardKinematics(robot.model, robot.data, q)
        for k in range(1, robot.n + 1):
            placement, body = robot.data.oMi[k], data.body(link_name(k))
            np.testing.assert_allclose(body.xpos, placement.translation, rtol=0, atol=close)
            np.testing.assert_allclose(
                body.xmat.reshape(3, 3), placement.rotation, rtol=0, atol=close
            )


def times_mass(model, data, column):
    product = np.zeros(model.nv)
    mujoco.mj_mulM(model, data, product, column)
    return product


@pytest.mark.parametrize("name", ["iiwa14", "iiwa14_bullet", "iiwa7", "panda", "xarm7", "kinova"])
def test_built_in_arms(arm, name):
    judge(arm(name))


@pytest.mark.parametrize(
    "second",
    [{"kind": "prismatic", "axis": "1 2 3"}, {"kind": "continuous", "axis": "0 -1 0", "more": ""}],
)
def test_prismatic_and_continuous_joints(urdf, second):
    if second["kind"] == "continuous":
        second |= {"more": '<limit velocity="2" effort="3"/>'}
    judge(urdf.load(urdf.two_links(rpy="0.1 0.2 0.3", **second)))


def test_rotor_inertia_counts_in_both(urdf, tmp_path):
    urdf.write(urdf.two_links())
    path = tmp_path / "small.toml"
    path.write_text('urdf = "small.urdf"\narmature = [0.5, 0.25]\n')
    robot = load_robot(path)
    judge(robot)
    assert (arm_spec(robot).compile().dof_armature == [0.5, 0.25]).all()


def test_without_mujoco_the_install_line_is_told(arm, monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'hitjoints\[sim\]'"):
        arm_spec(arm("iiwa14"))


@pytest.mark.filterwarnings("ignore::hitjoints.loading.load.ModelWarning")
def test_inertia_that_no_body_has_is_refused_in_a_line(urdf):
    flat = urdf.two_links().replace('ixx="', 'ixx="9', 1)
    robot = urdf.load(flat)
    impact = ImpactState(Contact(2), np.eye(3)[1], 1.0, np.zeros(2), np.zeros(2), np.zeros(3))
    with pytest.raises(ModelError, match=r"engine refuses it .inertia must satisfy A . B >= C"):
        build_scene(robot, impact, EngineSetting())
