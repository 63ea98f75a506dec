"""The box and the table in the physics engine.

The box stands on small feet, each a spring and a damper that do not pull, and Coulomb's friction.
The engine finds normal forces and friction together, so that slip lifts a foot that is firm: the
share `SOFT` of its impedance leaves the feet plain springs, and a ratio of 1 / `SOFT` between
friction and normal makes friction as firm as ever. Without that a turning box would curl by half
of what it should, and a sliding one would hop.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.constants import GRAVITY
from hitjoints.evidence.physics.engine_arm import quaternion
from hitjoints.goals.sliding import Support, support_nodes
from hitjoints.model.engine import engine

if TYPE_CHECKING:
    from hitjoints.types import Array

SOFT = 1e-4
"""The engine's impedance of a contact. It is then a plain spring and damper, to that share: it
yields to whatever moves the two bodies. With 0.9999 it would hold them to the motion of the two
alone, against servos and springs behind the arm, and lift what slips."""
FOOT = 1e-3
"""Share of the box's shortest edge that is the radius of a foot."""


def set_options(spec: Any, timestep: float) -> None:
    """Set the engine up for contacts that are computed to the last digit.

    The integrator is Euler's, but implicit in what servos make of velocities.
    """
    mujoco = engine()
    option = spec.option
    option.timestep = timestep
    option.gravity = (0, 0, -GRAVITY)
    option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    option.impratio = 1 / SOFT
    option.tolerance, option.iterations = 1e-12, 100
    # A state that is lost is told, not replaced by the one at the beginning.
    option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_AUTORESET)
    option.enableflags |= int(mujoco.mjtEnableBit.mjENBL_DIAGEXACT)


def add_box(
    spec: Any, centre: Array, axes: Array, mass: float, size: tuple[float, float, float]
) -> None:
    """Add a free box of even density."""
    mujoco = engine()
    box = spec.worldbody.add_body(name="box", pos=centre, quat=quaternion(axes))
    box.add_freejoint()
    half = [edge / 2 for edge in size]
    shape = box.add_geom(name="box", type=mujoco.mjtGeom.mjGEOM_BOX, size=half, mass=mass)
    shape.contype = shape.conaffinity = 0


def add_table(
    spec: Any,
    centre: Array,
    size: tuple[float, float, float],
    friction: float,
    support: Support,
    settling: float,
) -> None:
    """Add a level table under a box, and the feet that the box stands on.

    Args:
        spec: with the box.
        centre: (3,) m, of the box.
        size: (3,) m, of the box.
        friction: mu.
        support: "corners": four feet; "face": 36, at Gauss-Lobatto points, each as stiff as its
            weight, so that the pressure is that of an even face whose edges are edges.
        settling: s, the time constant in which the springs take the weight.
    """
    mujoco = engine()
    half = np.array(size) / 2
    kind = mujoco.mjtGeom
    top = (0, 0, centre[2] - half[2])
    silent(spec.worldbody.add_geom(name="table", type=kind.mjGEOM_PLANE, pos=top, size=(5, 5, 0.1)))
    nodes, weights = support_nodes(support)
    radius = FOOT * min(size)
    # Per unit of mass: how much a force at a foot, straight up, moves the foot.
    about_x, about_y = (half[1] ** 2 + half[2] ** 2) / 3, (half[0] ** 2 + half[2] ** 2) / 3
    for i, (x, along) in enumerate(zip(half[0] * nodes, weights, strict=True)):
        for j, (y, across) in enumerate(zip(half[1] * nodes, weights, strict=True)):
            name = f"foot_{i}_{j}"
            foot = spec.body("box").add_geom(
                name=name, type=kind.mjGEOM_SPHERE, size=(radius, 0, 0),
                pos=(x, y, radius - half[2]),
            )  # fmt: skip
            silent(foot)
            share = along * across * (1 + x**2 / about_y + y**2 / about_x)
            spring = -share / settling**2, -2 * share / settling
            add_pair(spec, "table", name, friction, spring, SOFT * share)


def add_pair(
    spec: Any,
    one: str,
    other: str,
    friction: float,
    spring: tuple[float, float],
    impedance: float = SOFT,
) -> None:
    """Let two shapes touch, with friction or without.

    Args:
        spec: with both.
        one: its name.
        other: its name.
        friction: mu; it takes hold within a step.
        spring: -stiffness (1/s^2) and -damping (1/s), per unit of effective mass: below 0 they are
            no time constants.
        impedance: of the engine, the same at any depth.
    """
    spec.add_pair(
        geomname1=one,
        geomname2=other,
        condim=3 if friction > 0 else 1,
        friction=(friction, friction, 0, 0, 0),
        solref=spring,
        solreffriction=(0.0, -impedance / spec.option.timestep),
        solimp=solimp(impedance),
    )


def solimp(impedance: float) -> tuple[float, ...]:
    """Return the engine's five numbers for an impedance that is the same at any depth."""
    return impedance, impedance, 0.001, 0.5, 2.0


def silent(shape: Any) -> None:
    """Let a shape weigh nothing, and collide with nothing but what pairs name."""
    shape.contype = shape.conaffinity = 0
    shape.mass = 0
