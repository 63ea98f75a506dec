"""Arms small enough for pencil and paper."""

import numpy as np
import pytest

from hitjoints.dynamics.inertia import inertia_along, inertia_and_gradient_along, inverse_inertia
from hitjoints.dynamics.kinematics import jacobian, manipulability, position
from hitjoints.errors import InfeasibleError
from hitjoints.model.robot import Contact

L1, L2, M1, M2 = 0.5, 0.4, 3.0, 1.7
X, Y = np.array([1.0, 0, 0]), np.array([0, 1.0, 0])
POINT = (0, 0, 0)


def along(angle):
    return np.array([np.cos(angle), np.sin(angle), 0.0])


@pytest.fixture
def one_link(urdf):
    """A point mass M1 at the distance L1 from a hinge."""
    return urdf.load(
        urdf.base,
        urdf.link("link_1", mass=M1, com=(L1, 0, 0), moments=POINT),
        urdf.joint("joint_1", "base", "link_1", at="0 0 0"),
    )


@pytest.fixture
def two_link(urdf):
    """The planar 2R arm: point masses M1 at the elbow and M2 at the tip."""
    return urdf.load(
        urdf.base,
        urdf.link("link_1", mass=M1, com=(L1, 0, 0), moments=POINT),
        urdf.link("link_2", mass=M2, com=(L2, 0, 0), moments=POINT),
        urdf.joint("joint_1", "base", "link_1", at="0 0 0"),
        urdf.joint("joint_2", "link_1", "link_2", at=f"{L1} 0 0"),
    )


TIP = Contact(2, (L2, 0, 0))


def two_link_tip(q1, q2, angle):
    """Return inertia and gradient at the tip of the planar 2R arm along an angle.

    The tip mass is felt in full. The elbow moves at the tip's speed along link 2 over sin(q2), so
    along link 2 its mass adds M1 / sin^2(q2): Lambda = M2 I + M1 / sin^2(q2) e2 e2^T.
    """
    theta = angle - q1 - q2
    felt = M2 * np.sin(q2) ** 2 + M1
    share = np.sin(q2) ** 2 / felt
    mobility = np.sin(theta) ** 2 / M2 + np.cos(theta) ** 2 * share
    by_q1 = np.sin(2 * theta) * (share - 1 / M2)
    by_q2 = by_q1 + np.cos(theta) ** 2 * M1 * np.sin(2 * q2) / felt**2
    return 1 / mobility, -np.array([by_q1, by_q2]) / mobility**2


@pytest.mark.parametrize("q", [-1.0, -0.2, 0.3, 0.9])
@pytest.mark.parametrize("angle", [0.0, 1.0, 2.5])
def test_one_link(one_link, q, angle):
    r, theta = 0.7, angle - q
    inertia, gradient = inertia_and_gradient_along(
        one_link, np.array([q]), Contact(1, (r, 0, 0)), along(angle)
    )
    expected = M1 * L1**2 / (r * np.sin(theta)) ** 2
    assert inertia == pytest.approx(expected, rel=1e-14)
    assert gradient.shape == (1,)
    assert gradient[0] == pytest.approx(2 * expected / np.tan(theta), rel=1e-13)


def test_one_link_other_quantities(one_link):
    contact = Contact(1, (L1, 0, 0))
    np.testing.assert_allclose(position(one_link, [0.0], contact), [L1, 0, 0])
    np.testing.assert_allclose(jacobian(one_link, [0.0], contact), [[0], [L1], [0]])
    np.testing.assert_allclose(inverse_inertia(one_link, [0.0], contact), np.diag([0, 1 / M1, 0]))
    assert manipulability(one_link, [0.0], contact) == 0
    with pytest.raises(InfeasibleError):
        inertia_along(one_link, np.zeros(1), contact, X)


@pytest.mark.parametrize("q", [(0.3, 0.8), (-0.9, 0.4), (0.2, -0.95), (0.0, 1.0)])
@pytest.mark.parametrize("angle", np.linspace(0, np.pi, 7))
def test_two_link_tip(two_link, q, angle):
    inertia, gradient = inertia_and_gradient_along(two_link, np.array(q), TIP, along(angle))
    expected, expected_gradient = two_link_tip(*q, angle)
    assert inertia == pytest.approx(expected, rel=1e-13)
    np.testing.assert_allclose(gradient, expected_gradient, rtol=1e-12, atol=1e-12)


def test_two_link_matches_the_textbook_mass_matrix(two_link):
    """The same number from M and J as the textbooks print them."""
    q1, q2 = 0.3, 0.8
    c2 = np.cos(q2)
    m11 = (M1 + M2) * L1**2 + M2 * L2**2 + 2 * M2 * L1 * L2 * c2
    m12 = M2 * L2**2 + M2 * L1 * L2 * c2
    mass_matrix = np.array([[m11, m12], [m12, M2 * L2**2]])
    s1, s12, c1, c12 = np.sin(q1), np.sin(q1 + q2), np.cos(q1), np.cos(q1 + q2)
    jac = np.array([[-L1 * s1 - L2 * s12, -L2 * s12], [L1 * c1 + L2 * c12, L2 * c12], [0, 0]])
    np.testing.assert_allclose(jacobian(two_link, [q1, q2], TIP), jac, atol=1e-15)
    expected = jac @ np.linalg.inv(mass_matrix) @ jac.T
    found = inverse_inertia(two_link, [q1, q2], TIP)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-14)
    np.testing.assert_array_equal(found, found.T)


def test_two_link_across_link_two_is_the_tip_mass_alone(two_link):
    q = np.array([0.4, 0.7])
    assert inertia_along(two_link, q, TIP, along(q.sum() + np.pi / 2)) == pytest.approx(M2)


def test_stretched_two_link_arm_cannot_move_along_itself(two_link):
    with pytest.raises(InfeasibleError, match="joint 2 cannot move along"):
        inertia_along(two_link, np.array([0.3, 0.0]), TIP, along(0.3))


def test_elbow_of_the_two_link_arm(two_link):
    """The origin of joint 2 turns about joint 1; with q2 = pi / 2 the tip mass adds in part.

    With joint 2 free, M1 L1^2 + M2 L1^2 sin^2(q2) resists at joint 1.
    """
    q1, q2 = 0.25, 0.9
    inertia, gradient = inertia_and_gradient_along(
        two_link, np.array([q1, q2]), Contact(2), along(q1 + np.pi / 2)
    )
    assert inertia == pytest.approx(M1 + M2 * np.sin(q2) ** 2, rel=1e-14)
    np.testing.assert_allclose(gradient, [0, M2 * np.sin(2 * q2)], rtol=1e-13, atol=1e-13)


def test_prismatic_carriage(urdf):
    """A mass on a slide: m along it, m / cos^2 at an angle, wherever it stands."""
    slide = urdf.load(
        urdf.base,
        urdf.link("link_1", mass=M1, moments=POINT),
        urdf.joint("joint_1", "base", "link_1", "prismatic", axis="1 0 0"),
    )
    for q in (-0.5, 0.0, 0.8):
        inertia, gradient = inertia_and_gradient_along(slide, np.array([q]), Contact(1), along(0.6))
        assert inertia == pytest.approx(M1 / np.cos(0.6) ** 2, rel=1e-14)
        np.testing.assert_allclose(gradient, [0], atol=1e-13)
    with pytest.raises(InfeasibleError):
        inertia_along(slide, np.zeros(1), Contact(1), Y)


def test_pendulum_on_a_carriage(urdf):
    """Along the slide the carriage is felt in full, the bob through its rod: m1 + m2 cos^2(q2)."""
    crane = urdf.load(
        urdf.base,
        urdf.link("link_1", mass=M1, com=(0, 0, 0), moments=POINT),
        urdf.link("link_2", mass=M2, com=(L2, 0, 0), moments=POINT),
        urdf.joint("joint_1", "base", "link_1", "prismatic", axis="1 0 0"),
        urdf.joint("joint_2", "link_1", "link_2", at="0 0 0"),
    )
    q = np.array([0.2, 0.7])
    inertia, gradient = inertia_and_gradient_along(crane, q, Contact(2), X)
    assert inertia == pytest.approx(M1 + M2 * np.cos(q[1]) ** 2, rel=1e-14)
    np.testing.assert_allclose(gradient, [0, -M2 * np.sin(2 * q[1])], rtol=1e-13, atol=1e-13)
