"""The model check finds numbers no arm can have, says what they spoil, and leaves real arms be."""

import re
import warnings
from importlib import resources

import numpy as np
import pinocchio as pin
import pytest

from hitjoints.dynamics.inertia import inertia_along, inverse_inertia
from hitjoints.errors import ModelError
from hitjoints.loading.check import check_arm
from hitjoints.loading.load import ModelWarning, load_robot, read_arm
from hitjoints.loading.source import describe
from hitjoints.loading.tensors import nearest_tensor
from hitjoints.model.robot import Contact

PHANTOM = (
    '<link name="flange"><inertial><mass value="1e-6"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)


def issues_of(path, *, quiet=True, **options):
    """Return what is found, apart from the notes that no data of the drives is there."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore" if quiet else "error")
        robot = load_robot(path, **options)
    found = check_arm(read_arm(describe(path), **options), robot)
    return [issue for issue in found if issue.link != "every joint"]


@pytest.fixture
def last_link(urdf):
    """Return the issues of a three-joint arm whose last link is as given."""

    def check(xml_of_link):
        joints = [
            urdf.joint("joint_1", "base", "link_1"),
            urdf.joint("joint_2", "link_1", "link_2", rpy="1.2 0 0"),
            urdf.joint("joint_3", "link_2", "link_3", rpy="-0.8 0 0"),
        ]
        links = [urdf.link("link_1"), urdf.link("link_2", mass=1.5), xml_of_link]
        return issues_of(urdf.write(urdf.robot(urdf.base, *links, *joints)))

    return check


@pytest.fixture
def phantom(urdf):
    clean = (resources.files("hitjoints.robots") / "iiwa14.urdf").read_text()
    assert '<link name="flange"/>' in clean
    return urdf.write(clean.replace('<link name="flange"/>', PHANTOM), "iiwa14_phantom.urdf")


def test_a_plain_arm_has_no_issues(last_link, urdf):
    assert last_link(urdf.link("link_3")) == []


def test_phantom_inertia_is_measured(phantom, arm):
    with pytest.warns(ModelWarning, match="iiwa14_phantom: flange: radius of gyration 1e\\+03 m"):
        robot = load_robot(phantom)
    (issue,) = issues_of(phantom)
    assert (issue.severity, issue.link) == ("error", "flange")
    assert "from a mass of 1e-06 kg" in issue.problem
    found = re.search(r"at joint 7 by ([\d.]+) in the median \(up to ([\d.]+)\)", issue.effect)
    median, most = map(float, found.groups())
    assert 2.0 < median < 2.4
    assert most > 4
    # The same ratio, measured here on other configurations.
    rng, ratios = np.random.default_rng(5), []
    for q in rng.uniform(robot.lower, robot.upper, (300, 7)):
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        good, bad = (inertia_along(r, q, Contact(7), h) for r in (arm("iiwa14"), robot))
        ratios.append(bad / good)
    assert np.median(ratios) == pytest.approx(median, rel=0.1)


def test_effect_of_a_turned_tensor_is_that_of_the_link(urdf):
    """Taking the link's tensor away must leave exactly the rest, however its origin is turned."""
    big = urdf.link("tool", mass=1e-6, com=(0, 0, 0), moments=(0.1, 1, 1), rpy='rpy="0.7 0.4 1.9"')
    mount = urdf.joint("mount", "link_2", "tool", "fixed", at="0 0 0", rpy="1.3 -0.9 0.6")
    xml = urdf.two_links(rpy="1.2 0 0")
    bad = urdf.write(xml.replace("</robot>", big + mount + "</robot>"))
    (issue,) = issues_of(bad)
    assert issue.link == "tool"
    found = re.search(r"at joint 2 by ([\d.]+) in the median \(up to ([\d.]+)\)", issue.effect)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        given = load_robot(bad)
    clean = urdf.load(xml)
    rng, ratios = np.random.default_rng(0), []
    for q in rng.uniform(-1, 1, (100, 2)):
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        ratios.append(
            inertia_along(given, q, Contact(2), h) / inertia_along(clean, q, Contact(2), h)
        )
    shown = [np.median(ratios), max(ratios)]
    assert [float(text) for text in found.groups()] == pytest.approx(shown, rel=0.05)


@pytest.mark.parametrize(("lowest", "severity"), [(-0.001, "note"), (-0.03, "error")])
def test_inertia_that_is_not_positive_definite(last_link, urdf, lowest, severity):
    (issue,) = last_link(urdf.link("link_3", moments=(lowest, 0.01, 0.01)))
    assert issue.severity == severity
    start = f"inertia not positive definite: principal moments {lowest:g},"
    assert issue.problem.startswith(start)
    assert "directional inertia at joint 3 by" in issue.effect
    assert issue.effect.endswith("that does not matter") == (severity == "note")
    products = last_link(urdf.link("link_3", products=(0.02, 0, 0)))
    assert "not positive definite: principal moments -0.01, 0.01, 0.03" in products[0].problem


@pytest.mark.parametrize(("largest", "severity"), [(0.01, "note"), (0.05, "error")])
def test_triangle_inequality(last_link, urdf, largest, severity):
    (issue,) = last_link(urdf.link("link_3", moments=(0.001, 0.001, largest)))
    assert issue.severity == severity
    shown = f"triangle inequality violated: principal moments 0.001, 0.001, {largest:g}"
    assert shown in issue.problem
    # A flat plate meets it with equality.
    assert last_link(urdf.link("link_3", moments=(0.005, 0.005, 0.01))) == []


def test_the_nearest_possible_tensor_has_no_negative_second_moment():
    rng = np.random.default_rng(0)
    for moments in ((0.001, 0.001, 0.01), (0.01, 0.01, -0.001), (1, 2, 5), (1, 2, 2.5)):
        axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
        tensor = axes @ np.diag(moments) @ axes.T
        mended = nearest_tensor(tensor)
        spread = np.trace(mended) / 2 * np.eye(3) - mended
        assert np.linalg.eigvalsh(spread).min() > -1e-12
        if moments[0] + moments[1] >= moments[2] and min(moments) > 0:
            np.testing.assert_allclose(mended, tensor, atol=1e-14)


def marks(urdf, count, moment, mass=1e-3):
    """Return a five-link arm with so many frames of impossible inertia on its last link."""
    parts = [urdf.base]
    for k in range(1, 6):
        light = (2e-4 * k, 2e-4 * k, 5e-5 * k)
        parts.append(urdf.link(f"seg{k}", mass=0.2 + k / 100, com=(0, 0, 0.12), moments=light))
        at, axis = ("0.05 0 0.15", "0 1 0") if k % 2 == 0 else ("0 0 0.2", "0 0 1")
        above = "base" if k == 1 else f"seg{k - 1}"
        parts.append(urdf.joint(f"turn{k}", above, f"seg{k}", at=at, axis=axis))
    for k in range(count):
        parts.append(urdf.link(f"mark{k}", mass=mass, com=(0, 0, 0), moments=(moment,) * 3))
        parts.append(urdf.joint(f"mount{k}", "seg5", f"mark{k}", "fixed", at="0 0 0.05"))
    return urdf.robot(*parts)


def test_small_phantoms_are_judged_together(urdf):
    """Each alone changes next to nothing, all of them half as much again."""
    path = urdf.write(marks(urdf, 6, 2e-3))
    with pytest.warns(ModelWarning, match="mark0, mark1, mark2, mark3, mark4, mark5"):
        robot = load_robot(path)
    (issue,) = issues_of(path)
    assert (issue.severity, issue.problem[:21]) == ("error", "6 impossible tensors,")
    found = re.search(
        r"together they .* by ([\d.]+) in the median \(up to ([\d.]+)\)", issue.effect
    )
    clean = urdf.load(marks(urdf, 6, 0))
    rng, ratios = np.random.default_rng(0), []
    for q in rng.uniform(robot.lower, robot.upper, (300, 5)):
        h = rng.normal(size=3)
        h /= np.linalg.norm(h)
        pair = [inertia_along(r, q, robot.flange, h) for r in (robot, clean)]
        ratios.append(pair[0] / pair[1])
    assert float(found[1]) > 1.05
    assert float(found[1]) < max(ratios)
    (alone,) = issues_of(urdf.write(marks(urdf, 1, 2e-3)))
    assert alone.severity == "note"


def test_a_phantom_that_does_not_matter_is_a_note(urdf):
    (issue,) = issues_of(urdf.write(marks(urdf, 1, 3e-8, mass=1e-8)), quiet=False)
    assert issue.severity == "note"
    assert "by 1 in the median (up to 1): that does not matter" in issue.effect


def test_placeholders_are_told(urdf):
    def chain(masses):
        links = [urdf.link(f"link_{k}", mass=mass) for k, mass in enumerate(masses, 1)]
        ends = ["base", *(f"link_{k}" for k in range(1, len(masses) + 1))]
        joints = [urdf.joint(f"joint_{k}", ends[k - 1], ends[k]) for k in range(1, len(masses) + 1)]
        return urdf.write(urdf.robot(urdf.base, *links, *joints))

    with pytest.warns(ModelWarning, match="3 links have the same mass 1 kg and tensor: placeh"):
        load_robot(chain([1, 2, 1, 1]))
    (issue,) = issues_of(chain([1, 2, 1, 1]))
    assert (issue.severity, issue.link) == ("warning", "link_1, link_3, link_4")
    assert issues_of(chain([1, 2, 1, 3]), quiet=False) == []


def test_what_is_not_known_of_the_drives_is_a_note(urdf):
    path = urdf.write(urdf.two_links())
    found = check_arm(read_arm(describe(path)), load_robot(path))
    assert [issue.problem for issue in found] == ["no acceleration limits", "no rotor inertias"]
    assert {issue.severity for issue in found} == {"note"}


def test_zero_mass(last_link, urdf):
    first, second = last_link('<link name="link_3"/>')
    assert (first.severity, first.link) == ("error", "joint_3")
    assert "mass matrix is not positive definite" in first.effect
    assert (second.severity, second.link, second.problem) == ("warning", "link_3", "zero mass")
    (issue,) = last_link(urdf.link("link_3", mass=0))
    assert issue.severity == "error"
    assert issue.problem.startswith("zero mass with principal moments 0.01,")


def test_negative_mass(last_link, urdf):
    # Pinocchio's mass centre of such a link has 30 digits: nothing is told from it.
    with pytest.raises(ModelError, match="link link_3: negative mass -1 kg"):
        last_link(urdf.link("link_3", mass=-1))


def test_mass_without_a_tensor_is_a_warning(last_link, urdf):
    (issue,) = last_link(urdf.link("link_3", moments=(0, 0, 0)))
    assert (issue.severity, issue.effect) == ("warning", "it deserves a second look")
    assert issue.problem == "zero inertia tensor with a mass of 1 kg"


def test_out_of_proportion_is_a_warning(last_link, urdf):
    (issue,) = last_link(urdf.link("link_3", moments=(0.16, 0.16, 0.16)))
    assert issue.severity == "warning"
    assert "radius of gyration 0.4 m is out of proportion to a link" in issue.problem
    (issue,) = last_link(urdf.link("link_3", moments=(0.04, 0.04, 0.04)))
    assert issue.severity == "note"
    assert issue.effect.endswith("that does not matter")


@pytest.mark.parametrize(
    ("link", "right", "wrong"),
    [
        ("link_1", 'iyy="0.09" iyz="0" izz="0.02"', 'iyy="0.09" iyz="0" izz="9"'),
        ("link_2", 'iyy="0.018" iyz="0" izz="0.044"', 'iyy="9" iyz="0" izz="9"'),
    ],
)
def test_wrong_link_near_the_base_is_measured_at_the_flange(urdf, link, right, wrong):
    """The origins of joints 1 and 2 cannot move: noise divided by noise is no effect."""
    clean = (resources.files("hitjoints.robots") / "iiwa14.urdf").read_text()
    assert clean.count(right) == 1
    wrong = clean.replace(right, wrong)
    (issue,) = issues_of(urdf.write(wrong))
    assert issue.link == link
    factor, most = re.search(r"at the flange by (\S+) .*\(up to (\S+)\)", issue.effect).groups()
    assert 1 <= float(factor) < float(most) < 1e3


def test_round_off_at_a_joint_that_cannot_move_is_no_effect(urdf):
    """Joint 2 lies on a tilted axis 1: its origin moves by round-off, which measures nothing."""
    xml = urdf.robot(
        urdf.base,
        urdf.link("link_1"),
        urdf.link("link_2", moments=(9, 9, 9)),
        urdf.link("link_3"),
        urdf.joint("joint_1", "base", "link_1", rpy="0.3 0.2 0.1"),
        urdf.joint("joint_2", "link_1", "link_2", at="0 0 0.3", rpy="1.2 0 0"),
        urdf.joint("joint_3", "link_2", "link_3", rpy="-0.8 0 0"),
    )
    (issue,) = issues_of(urdf.write(xml))
    assert issue.link == "link_2"
    assert "at the flange by" in issue.effect


def test_base_inertia_plays_no_part(urdf):
    base = urdf.link("base", mass=-5, moments=(-1, 0, 0))
    xml = urdf.two_links().replace(urdf.base, base)
    assert issues_of(urdf.write(xml), quiet=False) == []


def test_limits(urdf):
    zero = '<limit lower="0.5" upper="0.5" velocity="0" effort="0"/>'
    path = urdf.write(urdf.two_links(more=zero))
    with pytest.warns(ModelWarning, match="joint_2: zero or missing velocity limit"):
        load_robot(path)
    found = issues_of(path)
    assert [issue.severity for issue in found] == ["warning", "warning", "note"]
    assert {issue.link for issue in found} == {"joint_2"}
    assert [issue.problem for issue in found] == [
        "zero or missing velocity limit",
        "equal lower and upper position limits",
        "zero or missing effort limit",
    ]
    assert "counts as locked" in found[0].effect


def test_issue_in_words_and_by_name(urdf):
    zero = '<limit lower="-1" upper="1" velocity="0" effort="3"/>'
    (issue,) = issues_of(urdf.write(urdf.two_links(more=zero)))
    assert set(issue.as_dict()) == {"severity", "link", "problem", "effect"}
    assert str(issue) == f"joint_2: {issue.problem}; {issue.effect}"


@pytest.mark.parametrize("name", ["panda", "kinova", "ur10_robot", "talos_left_arm", "so101"])
def test_real_arms_have_no_errors(name):
    assert all(issue.severity != "error" for issue in issues_of(name, quiet=False))


def test_a_massless_tip_is_an_error_not_a_nan(urdf):
    xml = urdf.two_links().replace(urdf.link("link_2"), '<link name="link_2"/>')
    with pytest.warns(ModelWarning, match="joint_2: it carries no inertia"):
        robot = urdf.load(xml)
    q, h = np.array([0.1, 0.2]), np.array([0.0, 1.0, 0.0])
    for ask in (
        lambda: inertia_along(robot, q, Contact(2), h),
        lambda: inverse_inertia(robot, q, 2),
    ):
        with pytest.raises(ModelError, match="mass matrix is not positive definite"):
            ask()


def test_a_mass_fixed_to_a_massless_link_is_fine(urdf):
    hand = urdf.link("hand") + urdf.joint("mount", "link_2", "hand", "fixed", at="0.1 0 0")
    xml = urdf.two_links().replace(urdf.link("link_2"), '<link name="link_2"/>')
    robot = urdf.load(xml.replace("</robot>", hand + "</robot>"))
    assert pin.crba(robot.model, robot.model.createData(), robot.home)[1, 1] > 0
    assert inertia_along(robot, robot.home, Contact(2), np.array([0.0, 1.0, 0.0])) > 0
