"""The arm: its Pinocchio model, its limits, and the contact points on its links."""

from __future__ import annotations

import hashlib
import threading
from dataclasses import dataclass, field, fields
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from hitjoints.errors import InputError, ModelError
from hitjoints.model.turns import nearest_turn, search_range
from hitjoints.told import Told
from hitjoints.vectors import all_finite, real

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from numpy.typing import ArrayLike, NDArray

    from hitjoints.model.tool import Tool

FARTHEST = 100.0
"""m from a joint to a point of its link; of what lies farther, rounding is what remains."""
NO_MASS = "no link has mass, so there are no inertias, only kinematics"
COINCIDE = 1e-3  # m; origins that are nearer than this to each other are one


@dataclass(frozen=True)
class Contact:
    """The point that hits: rigidly attached to a joint's link.

    Args:
        joint: 1-based number of the joint.
        offset: (3,) m, from the origin of the joint's frame, in that frame. Zero is the origin.
    """

    joint: int
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if isinstance(self.joint, np.integer):
            # Pinocchio takes Python's integers alone.
            object.__setattr__(self, "joint", int(self.joint))
        expected = f"three finite numbers in metres, none beyond {FARTHEST:g} m"
        values = real(self.offset, "offset", expected)
        if values.shape != (3,) or not (np.abs(values) <= FARTHEST).all():
            raise InputError("offset", self.offset, expected)
        object.__setattr__(self, "offset", tuple(float(v) for v in values))

    @cached_property
    def placement(self) -> Any:
        """The contact point's frame in its joint's frame, pin.SE3."""
        import pinocchio as pin

        return pin.SE3(np.eye(3), np.array(self.offset))

    def __reduce__(self) -> tuple[type[Contact], tuple[Any, ...]]:
        """Pickle what it was made of."""
        return type(self), (self.joint, self.offset)


@dataclass(frozen=True, eq=False, repr=False)
class Robot(Told):
    """A fixed-base serial arm. Made by `load_robot`; equal when every quantity is.

    Threads may share one; processes get a copy each, by pickle.

    Attributes:
        name: the name it was loaded by.
        model: Pinocchio model, one degree of freedom per joint; not to be written to.
        hitting_joints: joints (1-based) a hit is planned with when none is named.
        home: (n,) rad, a configuration in the middle of the useful workspace.
        flange: the end of the arm, on the last joint; the point chi_{n+1} of Eq. 14. With a tool
            it is the tool's tip.
        xml: the URDF as given to Pinocchio.
        title: where the numbers come from.
        source: where the numbers come from.
        licence: where the numbers come from.
        package_directory: the folder of the description, "" for a text; its meshes are looked for
            from there.
        package_dirs: folders that hold the packages of `package://` addresses.
        tool: what is welded to the flange, which `model` and `xml` hold already.
        acceleration: (n,) rad/s^2, acceleration limits of the drives; None when not known.
        jerk: (n,) rad/s^3, jerk limits; None when not known.
        rotor_inertia: (n,) kg m^2, reflected through the gears; None when not known. The mass
            matrix holds `model.armature` instead, which is zero unless the TOML says otherwise.
        joint_stiffness: (n,) N m/rad, of the gears and torque sensors; None when not known.
        provenance: where each of these four comes from, by name.
        asked: the arguments of `load_robot` it was made with; None where no file can hold them.
        kept: what others have derived from it, such as compiled formulas; not copied along.
    """

    name: str
    model: Any = field(repr=False)
    hitting_joints: tuple[int, ...]
    home: NDArray[np.float64]
    flange: Contact
    xml: str = field(repr=False)
    title: str = ""
    source: str = field(default="", repr=False)
    licence: str = ""
    package_directory: str = field(default="", repr=False)
    package_dirs: tuple[str, ...] = field(default=(), repr=False)
    tool: Tool | None = field(default=None, repr=False)
    acceleration: NDArray[np.float64] | None = field(default=None, repr=False)
    jerk: NDArray[np.float64] | None = field(default=None, repr=False)
    rotor_inertia: NDArray[np.float64] | None = field(default=None, repr=False)
    joint_stiffness: NDArray[np.float64] | None = field(default=None, repr=False)
    provenance: Mapping[str, str] = field(default_factory=dict, repr=False)
    asked: Mapping[str, Any] | None = field(default=None, repr=False)
    kept: dict[Any, Any] = field(default_factory=dict, repr=False, init=False)
    _local: threading.local = field(default_factory=threading.local, repr=False, init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "home", _frozen(self.home))
        for name in ("acceleration", "jerk", "rotor_inertia", "joint_stiffness"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, _frozen(getattr(self, name)))

    @property
    def words(self) -> str:
        """What it is, in a line."""
        return f"{self.name}: {self.n} joints, hits with {', '.join(map(str, self.hitting_joints))}"

    def __reduce__(self) -> tuple[type[Robot], tuple[Any, ...]]:
        """Pickle what it was made of: work spaces and derived models stay with their process."""
        return type(self), tuple(getattr(self, item.name) for item in fields(self) if item.init)

    def __eq__(self, other: object) -> bool:
        """Tell whether two robots give the same numbers, such as a robot and its pickled copy."""
        if not isinstance(other, Robot):
            return NotImplemented
        mine, theirs = (
            (self.name, self.digest, self.flange),
            (other.name, other.digest, other.flange),
        )
        return mine == theirs and self._meshes == other._meshes

    def __hash__(self) -> int:
        """Return a hash that equal robots share."""
        return hash(self.digest)

    @property
    def n(self) -> int:
        """Number of joints."""
        return int(self.model.nv)

    @cached_property
    def has_mass(self) -> bool:
        """Whether any moving link weighs anything; without, only kinematics are known."""
        return any(body.mass > 0 for body in list(self.model.inertias)[1:])

    def require_mass(self) -> None:
        """Refuse what inertias are needed for.

        Raises:
            ModelError: no link has mass.
        """
        if not self.has_mass:
            raise ModelError(self.name, NO_MASS)

    @property
    def joint_names(self) -> list[str]:
        """Names of the joints, base to tip."""
        return list(self.model.names)[1:]

    @cached_property
    def lower(self) -> NDArray[np.float64]:
        """Lower position limits, (n,) rad (m for a prismatic joint); -inf for continuous joints."""
        return _frozen(self.model.lowerPositionLimit)

    @cached_property
    def upper(self) -> NDArray[np.float64]:
        """Upper position limits, (n,) rad."""
        return _frozen(self.model.upperPositionLimit)

    @cached_property
    def finite_limits(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Position limits, (n,) rad each; one turn around home where they are far or missing."""
        low, high = search_range(self.lower, self.upper, self.home, self.turning)
        return _frozen(low), _frozen(high)

    @cached_property
    def turning(self) -> NDArray[np.bool_]:
        """Which joints turn, (n,); the others slide."""
        kinds = [joint.shortname() for joint in list(self.model.joints)[1:]]
        return np.array([not kind.startswith("JointModelP") for kind in kinds])

    def nearest_turn(self, q: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return q, (n,) or (N, n) rad, with every angle the turn of 2 pi nearest to home."""
        return nearest_turn(q, self.lower, self.upper, self.home, self.turning)

    def velocity_ratio(self, qd: NDArray[np.float64]) -> float:
        """Return the greatest |qd| of joint velocities (..., n) in units of its limit."""
        limit = np.where(qd > 0, self.velocity_upper, -self.velocity_lower)
        moving = qd != 0
        return float(np.max(np.abs(qd[moving]) / limit[moving], initial=0.0))

    @cached_property
    def velocity_lower(self) -> NDArray[np.float64]:
        """Lower velocity limits, (n,) rad/s."""
        return _frozen(self.model.lowerVelocityLimit)

    @cached_property
    def velocity_upper(self) -> NDArray[np.float64]:
        """Upper velocity limits, (n,) rad/s. Zero means the joint is locked."""
        return _frozen(self.model.upperVelocityLimit)

    @cached_property
    def effort(self) -> NDArray[np.float64]:
        """Effort limits, (n,) N m."""
        return _frozen(self.model.upperEffortLimit)

    @cached_property
    def still(self) -> NDArray[np.float64]:
        """Zero joint velocities, (n,)."""
        return _frozen(np.zeros(self.n))

    @property
    def data(self) -> Any:
        """Pinocchio's work space, one per thread."""
        try:
            return self._local.data
        except AttributeError:
            self._local.data = self.model.createData()
            return self._local.data

    @cached_property
    def weightless_model(self) -> Any:
        """The same model without gravity: its RNEA derivatives hold d(M a)/dq alone."""
        import pinocchio as pin

        model = pin.Model(self.model)
        model.gravity = pin.Motion.Zero()
        return model

    @cached_property
    def _collision(self) -> tuple[Any, list[tuple[str, str]]]:
        from hitjoints.model.collision_shapes import build_shapes, read_shapes

        shapes, faults = read_shapes(self.xml)
        geometry, more = build_shapes(self.model, shapes, self.package_directory, self.package_dirs)
        return geometry, faults + more

    @property
    def shape_faults(self) -> list[tuple[str, str]]:
        """The collision shapes that cannot be read: their links and the reasons."""
        return self._collision[1]

    @property
    def collision_model(self) -> Any:
        """Pinocchio's geometry of the collision shapes.

        Raises:
            ModelError: a shape cannot be read, such as a mesh whose file is missing.
        """
        geometry, faults = self._collision
        if faults:
            (link, reason), count = faults[0], len(faults)
            which = f"the collision shape of {link}"
            if count > 1:
                which = f"{count} collision shapes, first that of {link},"
            raise ModelError(self.name, f"{which} cannot be read: {reason}")
        return geometry

    @cached_property
    def digest(self) -> str:
        """Hash of all that kinematics and dynamics depend on: same digest, same numbers."""
        parts = [self.xml.encode()]
        facts = (self.acceleration, self.jerk, self.rotor_inertia, self.joint_stiffness)
        arrays = (self.model.armature, self.lower, *facts)
        parts += [b"" if a is None else np.ascontiguousarray(a).tobytes() for a in arrays]
        return hashlib.sha256(b"\0".join(parts)).hexdigest()[:16]

    @cached_property
    def _meshes(self) -> str:
        """Hash of the meshes that clearance depends on, which the description only names."""
        from hitjoints.model.collision_shapes import mesh_digest

        return mesh_digest(self.xml, self.package_directory, self.package_dirs)

    @property
    def usual_joint(self) -> int:
        """The joint that hits when none is named: the last but one of the hitting joints."""
        return self.hitting_joints[-2:][0]

    @property
    def usual_contacts(self) -> tuple[Contact, ...]:
        """What hits when no joint is named: the hitting joints, and the tip of a tool."""
        if self.tool is None:
            return tuple(self._origins[joint] for joint in self.hitting_joints)
        others = (self._origins[joint] for joint in self.hitting_joints if joint != self.n)
        return (*others, self.flange)

    @cached_property
    def _origins(self) -> dict[int, Contact]:
        return {joint: Contact(joint) for joint in range(1, self.n + 1)}

    def contact(self, contact: Contact | int) -> Contact:
        """Return `contact` as a Contact of this robot; a plain number is that joint's origin.

        Raises:
            InputError: there is no such joint.
        """
        if type(contact) is int and contact in self._origins:
            return self._origins[contact]
        if not isinstance(contact, Contact):
            contact = Contact(contact)
        joint = contact.joint
        if type(joint) is not int or not 1 <= joint <= self.n:
            raise InputError("joint", joint, f"{self.name} has joints 1 to {self.n}")
        return contact

    def contacts(self, joints: Iterable[Contact | int] | None = None) -> tuple[Contact, ...]:
        """Return joints or contacts as Contacts of this robot, its `usual_contacts` by default.

        Raises:
            InputError: there is no such joint, none at all, or one twice.
        """
        if joints is None:
            joints = self.usual_contacts
        if not hasattr(joints, "__iter__"):
            raise InputError("joints", joints, "a list of joints, even of one")
        contacts = tuple(map(self.contact, joints))
        if not contacts or len(set(contacts)) < len(contacts):
            raise InputError("joint", [c.joint for c in contacts], "at least one, each once")
        return contacts

    def beyond(self, contact: Contact) -> Contact:
        """Return the point that the away condition compares a contact's joint with (Eq. 14).

        The next joint's origin, chi_{k+1}; where it coincides with that of joint k in every
        configuration, the next that does not; the flange after the last joint.
        """
        for joint in range(contact.joint + 1, self.n + 1):
            ahead = float(np.linalg.norm(self.model.jointPlacements[joint].translation))
            if ahead > COINCIDE or not self.turning[joint - 1]:
                return self._origins[joint]
        return self.flange

    def configuration(
        self, q: ArrayLike, argument: str = "q", *, finite: bool = True
    ) -> NDArray[np.float64]:
        """Return `q` as one (n,) or many (N, n) finite configurations.

        Args:
            q: rad.
            argument: what to call it when it is refused.
            finite: look at every number; if not, the caller does.

        Raises:
            InputError: wrong shape, or not finite.
        """
        array = real(q, argument, f"{self.n} numbers in rad")
        if array.shape[-1:] != (self.n,) or array.ndim not in (1, 2):
            raise InputError(
                argument,
                _brief(array),
                f"{self.name} takes {self.n} joint positions (or rows of them), "
                f"this has shape {array.shape}",
            )
        if finite and not all_finite(array):
            raise InputError(argument, _brief(array), "every joint position must be finite")
        return array

    def one_configuration(self, q: ArrayLike, argument: str = "q") -> NDArray[np.float64]:
        """Return `q` as one finite configuration (n,); errors as `configuration`."""
        array = self.configuration(q, argument)
        if array.ndim != 1:
            raise InputError(argument, _brief(array), "one configuration is needed, not rows")
        return array

    def within_limits(self, q: ArrayLike, argument: str = "q") -> NDArray[np.float64]:
        """Return one configuration (n,) that lies within the position limits.

        Raises:
            InputError: it does not; the message names the joint and both bounds.
        """
        array = self.one_configuration(q, argument)
        for i in np.flatnonzero((array < self.lower) | (array > self.upper)):
            raise InputError(
                argument,
                _brief(array),
                f"joint {i + 1} is at {array[i]:.6g}, outside its limits "
                f"[{self.lower[i]:.6g}, {self.upper[i]:.6g}]",
            )
        return array


def _frozen(values: ArrayLike) -> NDArray[np.float64]:
    array = np.array(values, dtype=float)
    array.setflags(write=False)
    return array


def _brief(array: NDArray[np.float64]) -> str:
    return np.array2string(array, precision=4, threshold=12, separator=",").replace("\n", "")
