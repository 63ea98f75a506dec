"""Restitution and contact time: integrated by SciPy, and between two masses in MuJoCo."""

import math

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from hitjoints.errors import InputError
from hitjoints.evidence.physics.engine_box import SOFT, solimp
from hitjoints.impact.restitution import (
    LEAST,
    contact_spring,
    damping_ratio,
    restitution_of,
)

SOME = (0.0, 0.02, 0.1, math.exp(-2), 0.3, 0.5, 0.8, 0.99, 1.0)


@given(st.floats(LEAST, 1))
def test_the_damping_ratio_gives_the_restitution(restitution):
    assert restitution_of(damping_ratio(restitution)) == pytest.approx(restitution, rel=1e-6)


def test_critical_damping_is_no_gap():
    assert restitution_of(1.0) == pytest.approx(math.exp(-2), rel=1e-12)
    for z in (1 - 1e-5, 1 + 1e-5):
        assert restitution_of(z) == pytest.approx(math.exp(-2), rel=1e-4)


@pytest.mark.parametrize("restitution", SOME)
def test_the_spring_integrated_by_scipy(restitution):
    # Penetration r under r'' = -k r - b r' until the force is gone: the contact cannot pull.
    time = 0.003
    k, b = contact_spring(restitution, time)

    def force(t, state):
        return k * state[0] + b * state[1]

    force.terminal, force.direction = True, -1
    way = solve_ivp(
        lambda t, s: (s[1], -force(t, s)), (0, 10 * time), (0.0, 2.0), events=force, rtol=1e-10,
        atol=1e-13, method="DOP853",
    )  # fmt: skip
    assert way.t_events[0][0] == pytest.approx(time, rel=1e-6)
    assert -way.y_events[0][0][1] / 2.0 == pytest.approx(max(restitution, LEAST), rel=1e-5)


@pytest.mark.parametrize("restitution", SOME)
def test_two_masses_in_the_engine(restitution):
    masses, time, steps = (4.0, 1.5), 5e-4, 400
    k, b = contact_spring(restitution, time)
    spec = mujoco.MjSpec()
    spec.option.timestep, spec.option.gravity = time / steps, (0, 0, 0)
    for i, mass in enumerate(masses):
        body = spec.worldbody.add_body(pos=(0.1 * i, 0, 0))
        body.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=(1, 0, 0))
        kind = mujoco.mjtGeom.mjGEOM_BOX if i else mujoco.mjtGeom.mjGEOM_SPHERE
        body.add_geom(name=str(i), type=kind, size=(0.05,) * 3, mass=mass, contype=0, conaffinity=0)
    spec.add_pair(geomname1="0", geomname2="1", condim=1, solref=(-k, -b), solimp=solimp(SOFT))
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qvel[0] = 1.0
    for _ in range(2 * steps):
        mujoco.mj_step(model, data)
    parting = data.qvel[1] - data.qvel[0]
    assert parting == pytest.approx(restitution, abs=2e-3)
    assert masses @ data.qvel == pytest.approx(masses[0], rel=1e-9)


@pytest.mark.parametrize("value", [-0.1, 1.01, math.nan, math.inf])
def test_what_is_no_restitution(value):
    with pytest.raises(InputError, match="restitution"):
        contact_spring(value, 1e-3)
    assert np.isfinite(contact_spring(0.0, 1e-3)).all()
