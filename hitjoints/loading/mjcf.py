"""Read an MJCF description into a tree of links and joints, as MuJoCo itself understands it.

MuJoCo is the one that knows its defaults, includes, angles and inertias taken from shapes; what it
compiles is written over into the terms of a URDF. It moves a body about a point of its joint's
axis, a URDF about its link's origin: a link's frame is that of its joint here, so positions mean
the same in both.
"""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np

from hitjoints.errors import ModelError
from hitjoints.model.engine import compiled, engine
from hitjoints.model.numbers import written
from hitjoints.model.tree import Body, Connection, Tree, roll_pitch_yaw, turn_about

if TYPE_CHECKING:
    from hitjoints.types import Array

WORLD = "world"
KINDS = ("floating", "ball", "prismatic", "revolute")  # of joints, by MuJoCo's numbers
HOME = "home"
SOLIDS = {
    "box": ("size",),
    "sphere": ("radius",),
    "cylinder": ("radius", "length"),
    "capsule": ("radius", "length"),
    "mesh": (),
}
"""The shapes that both formats have, and URDF's words for their lengths."""


def read_mjcf(text: str, path: Path | None, source: str) -> Tree:
    """Read an MJCF.

    Its armature, ranges, force limits, joint equalities and the keyframe `home` are read; velocity
    limits are no part of the format. Sites become links; loose objects and the shapes of the world
    are left out.

    Args:
        text: the MJCF.
        path: of its file, from where it includes others; None for a text.
        source: what to call it in messages.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        ModelError: MuJoCo refuses it.
    """
    mujoco = engine()
    try:
        if path is not None:
            spec = mujoco.MjSpec.from_file(str(path))
        else:
            spec = mujoco.MjSpec.from_string(text)
    except (ValueError, RuntimeError) as error:
        reason = " ".join(str(error).split()).removeprefix("Error: ")
        raise ModelError(source, f"MuJoCo cannot read it ({reason})") from None
    spec.compiler.fusestatic = False
    model = compiled(spec, source)
    meshes = Path("" if path is None else path.parent, spec.meshdir)
    tree = _Reader(mujoco, model, meshes.absolute()).tree(spec.modelname or "robot")
    _check_finite(tree, source)
    return tree


def _check_finite(tree: Tree, source: str) -> None:
    for kind, parts in (("body", tree.bodies), ("joint", tree.joints)):
        for name, part in parts.items():
            for item in fields(part):
                value = getattr(part, item.name)
                if isinstance(value, (float, np.ndarray)) and not np.isfinite(value).all():
                    reason = f"{kind} {name}: its {item.name} is not finite ({value})"
                    raise ModelError(source, reason)


class _Reader:
    """Writes what MuJoCo has compiled over into links and joints.

    Args:
        mujoco: the module.
        model: its MjModel.
        meshes: the folder of its mesh files.
    """

    def __init__(self, mujoco: Any, model: Any, meshes: Path) -> None:
        self.mujoco, self.model, self.meshes = mujoco, model, meshes
        self.bodies: dict[str, Body] = {WORLD: Body(WORLD)}
        self.joints: dict[str, Connection] = {}
        # Of each body: its link, and where the body's frame is in that of the link.
        self.places: list[tuple[Array, Array]] = [(np.eye(3), np.zeros(3))]
        self.links = [WORLD]
        kind = mujoco.mjtObj
        keys = [mujoco.mj_id2name(model, kind.mjOBJ_KEY, i) for i in range(model.nkey)]
        self.home = model.key_qpos[keys.index(HOME)] if HOME in keys else None

    def tree(self, name: str) -> Tree:
        """Return the whole tree."""
        loose = self._loose()
        for body in range(1, self.model.nbody):
            if self.model.body_rootid[body] in loose:
                self.places.append((np.eye(3), np.zeros(3)))
                self.links.append("")
            else:
                self._read_body(body)
        for site in range(self.model.nsite):
            self._read_site(site)
        self._read_equalities()
        return Tree(name, WORLD, self.bodies, self.joints)

    def _loose(self) -> set[int]:
        """Return the bodies on the world that float and carry nothing that turns or slides."""
        roots = self.model.body_rootid[self.model.jnt_bodyid]
        kinds = self.model.jnt_type
        free = {int(root) for root, kind in zip(roots, kinds, strict=True) if kind == 0}
        return free - {int(root) for root, kind in zip(roots, kinds, strict=True) if kind >= 2}

    def _read_body(self, body: int) -> None:
        model, name = self.model, self._name("BODY", body)
        above = self.links[int(model.body_parentid[body])]
        turn, at = self.places[int(model.body_parentid[body])]
        turn, at = turn @ _matrix(model.body_quat[body]), at + turn @ model.body_pos[body]
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        here = np.zeros(3)
        if not count:
            self._connect(f"{name}_mount", "fixed", above, name, turn, at)
        for i in range(first, first + count):
            link = name if i == first + count - 1 else f"{name}_{i - first}"
            anchor = model.jnt_pos[i]
            self._read_joint(i, above, link, turn, at + turn @ anchor)
            self.bodies.setdefault(link, Body(link))
            above, turn, at = link, np.eye(3), -anchor
            here = at
        self.places.append((np.eye(3), here))
        self.links.append(name)
        self.bodies[name] = self._body(body, name, here)

    def _body(self, body: int, name: str, here: Array) -> Body:
        model = self.model
        turn = _matrix(model.body_iquat[body])
        tensor = turn @ np.diag(model.body_inertia[body]) @ turn.T
        moments = tensor[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        first, count = int(model.body_geomadr[body]), int(model.body_geomnum[body])
        shapes = [self._shape(geom, here) for geom in range(first, first + count)]
        return Body(
            name,
            float(model.body_mass[body]),
            here + model.body_ipos[body],
            np.zeros(3),
            moments,
            has_inertial=bool(model.body_mass[body] > 0),
            shapes=tuple(shape for shape in shapes if shape is not None),
        )

    def _read_joint(self, i: int, above: str, link: str, turn: Array, at: Array) -> None:
        """Add a joint; its position is MuJoCo's, which is `ref` where the body is drawn."""
        model, name = self.model, self._name("JOINT", i)
        kind, axis, address = KINDS[model.jnt_type[i]], model.jnt_axis[i], model.jnt_qposadr[i]
        ref, limited = float(model.qpos0[address]), bool(model.jnt_limited[i])
        if kind == "revolute":
            turn = turn @ turn_about(axis, -ref)
            kind = kind if limited else "continuous"
        elif kind == "prismatic":
            at = at - ref * turn @ axis
        lower, upper = model.jnt_range[i] if limited else (0.0, 0.0)
        self._connect(
            name, kind, above, link, turn, at,
            axis=axis.copy(), lower=float(lower), upper=float(upper), effort=self._effort(i),
            has_limit=limited, armature=float(model.dof_armature[model.jnt_dofadr[i]]),
            home=None if self.home is None else float(self.home[address]),
        )  # fmt: skip

    def _connect(
        self, name: str, kind: str, above: str, link: str, turn: Array, at: Array, **more: Any
    ) -> None:
        axis = more.pop("axis", np.array([1.0, 0.0, 0.0]))
        xyz, rpy = np.array(at), roll_pitch_yaw(turn)
        self.joints[name] = Connection(name, kind, above, link, xyz, rpy, axis, **more)

    def _effort(self, joint: int) -> float:
        """Return the greatest force on a joint that holds both ways, 0 when none is told."""
        model, limits = self.model, []
        if model.jnt_actfrclimited[joint]:
            limits.append(min(abs(model.jnt_actfrcrange[joint])))
        for i in range(model.nu):
            on_joint = model.actuator_trntype[i] == self.mujoco.mjtTrn.mjTRN_JOINT
            if on_joint and model.actuator_trnid[i, 0] == joint and model.actuator_forcelimited[i]:
                gear = abs(model.actuator_gear[i, 0])
                limits.append(gear * min(abs(model.actuator_forcerange[i])))
        return float(min(limits, default=0.0))

    def _read_site(self, site: int) -> None:
        body = int(self.model.site_bodyid[site])
        above, name = self.links[body], self._name("SITE", site)
        if not above:
            return
        name = f"{name}_site" if name in self.bodies else name
        turn, at = self.places[body]
        at = at + turn @ self.model.site_pos[site]
        self.bodies[name] = Body(name)
        turn = turn @ _matrix(self.model.site_quat[site])
        self._connect(f"{name}_mount", "fixed", above, name, turn, at)

    def _read_equalities(self) -> None:
        """Let a joint mimic the one it is coupled with."""
        model = self.model
        for i in range(model.neq):
            if model.eq_type[i] != self.mujoco.mjtEq.mjEQ_JOINT or model.eq_obj2id[i] < 0:
                continue
            name, leader = (
                self._name("JOINT", j) for j in (model.eq_obj1id[i], model.eq_obj2id[i])
            )
            if name in self.joints and leader in self.joints:
                offset, factor = (float(v) for v in model.eq_data[i, :2])
                self.joints[name] = replace(
                    self.joints[name], mimic=leader, mimic_factor=factor, mimic_offset=offset
                )

    def _shape(self, geom: int, here: Array) -> Element | None:
        """Return a collision shape, or None for one that only shows."""
        model = self.model
        if not (model.geom_contype[geom] or model.geom_conaffinity[geom]):
            return None
        kind = self.mujoco.mjtGeom(int(model.geom_type[geom])).name.removeprefix("mjGEOM_").lower()
        turn, at, size = _matrix(model.geom_quat[geom]), model.geom_pos[geom], model.geom_size[geom]
        numbers: dict[str, str] = {}
        if kind == "mesh":
            mesh = int(model.geom_dataid[geom])
            # MuJoCo moves a mesh into its frame of inertia: the file's frame lies here.
            turn = turn @ _matrix(model.mesh_quat[mesh]).T
            at = at - turn @ model.mesh_pos[mesh]
            file = self._path(mesh)
            numbers = {"filename": file} if file else {}
            numbers["scale"] = written(model.mesh_scale[mesh])
        elif kind in SOLIDS:
            lengths = {"size": 2 * size, "radius": size[:1], "length": 2 * size[1:2]}
            numbers = {key: written(lengths[key]) for key in SOLIDS[kind]}
        shape = Element("collision")
        xyz, rpy = written(here + at), written(roll_pitch_yaw(turn))
        SubElement(shape, "origin", xyz=xyz, rpy=rpy)
        SubElement(SubElement(shape, "geometry"), kind, numbers)
        return shape

    def _path(self, mesh: int) -> str:
        """Return the file of a mesh, "" when its vertices stand in the MJCF."""
        start = int(self.model.mesh_pathadr[mesh])
        if start < 0:
            return ""
        paths = bytes(self.model.paths)
        return str(self.meshes / paths[start : paths.index(0, start)].decode())

    def _name(self, kind: str, number: int) -> str:
        found = self.mujoco.mj_id2name(
            self.model, getattr(self.mujoco.mjtObj, f"mjOBJ_{kind}"), int(number)
        )
        return str(found or f"{kind.lower()}_{number}")


def _matrix(quat: Array) -> Array:
    """Return the rotation matrix (3, 3) of a quaternion w, x, y, z of any length."""
    w, x, y, z = quat / np.linalg.norm(quat)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(np.eye(3) + 2 * w * cross + 2 * cross @ cross)
