"""What small descriptions with one fault or habit each end in, through the commands."""

import pytest

import hitjoints as hj


@pytest.fixture
def four_joints(urdf):
    """Write an arm whose joint 2 has its origin on the first joint's axis."""

    def write(limit=urdf.limit, **names):
        parts = [urdf.base]
        for k, (name, at, axis) in enumerate(
            (
                ("yaw", "0 0 0.1", "0 0 1"),
                ("shoulder", "0 0 0.1", "0 1 0"),
                ("elbow", "0 0 0.25", "0 1 0"),
                ("wrist", "0 0 0.25", "0 1 0"),
            ),
            1,
        ):
            above = "base" if k == 1 else f"seg{k - 1}"
            parts.append(urdf.link(f"seg{k}", mass=1 + k / 10, com=(0, 0, 0.12)))
            parts.append(urdf.joint(name, above, f"seg{k}", at=at, axis=axis, more=limit))
        flange = urdf.link("flange"), urdf.joint("f", "seg4", "flange", "fixed", at="0 0 0.1")
        return urdf.write(urdf.robot(*parts, *flange), "four.urdf")

    return write


def test_a_sweep_leaves_out_the_joint_that_nothing_moves(four_joints, run):
    path = four_joints()
    robot = hj.load_robot(path)
    assert robot.hitting_joints == (2, 3, 4)
    at = hj.position(robot, [0.2, 0.5, 0.4, 0.0], 4)
    swept = hj.sweep_joint(robot, at, [0, 1, 0], 2.0)
    assert swept.reachable.values.tolist() == [False, False, True]
    assert (swept.inertia.sel(joint=4) > 0).all()
    assert swept.inertia.sel(joint=2).isnull().all()
    # Right at its origin it is still not something to hit with.
    told = run("sweep", "joint", "--robot", path, "--object=0,0,0.2", "--joint", 2)
    assert told.code == 3
    assert told.err.startswith("no: unreachable: no joint of [2]")
    shown = ",".join(map(str, at.tolist()))
    assert run("sweep", "joint", "--robot", path, f"--object={shown}").code == 0


def test_a_plan_says_that_the_velocity_limits_are_zero(four_joints, urdf, run):
    path = four_joints(urdf.limit.replace('velocity="2"', 'velocity="0"'))
    with pytest.warns(hj.ModelWarning):
        at = hj.position(hj.load_robot(path), [0.2, 0.5, 0.4, 0.0], 4)
    shown = f"--object={','.join(map(str, at.tolist()))}", "--direction=0.3,0.9,0.1"
    told = run("plan", "--robot", path, *shown, "--joint", 4, "--no-away")
    assert told.code == 3
    assert "zero or missing velocity limit" in told.err
    assert "no: four: every velocity limit is zero or missing" in told.err
    text = 'urdf = "four.urdf"\nvelocity = [2, 2, 2, 2]'
    told = run("plan", "--robot", urdf.write(text, "four.toml"), *shown, "--joint", 4, "--no-away")
    assert told.code == 0
    assert "velocity" not in told.err
