"""The arm in the browser: what it is made of, where it stands, and what it says."""

import json
import re
import shlex
import signal
import subprocess
import sys
import threading
import urllib.request
from contextlib import contextmanager

import numpy as np
import pinocchio as pin
import pytest
import trimesh
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

import hitjoints as hj
from hitjoints.errors import InputError, MissingExtraError
from hitjoints.show.origin import is_foreign
from hitjoints.show.solids import THICKNESS, solids

PORT = 18_080
LIMIT = 60  # s, for a process that serves


@pytest.fixture
def viewer(arm):
    made = hj.view(arm("iiwa14"), port=PORT)
    yield made
    made.stop()


def press(viewer, label):
    """Do what a click in the browser does."""
    for handle in viewer._server.gui._gui_input_handle_from_uuid.values():
        if getattr(handle, "label", None) == label:
            for callback in handle._impl.update_cb:
                callback(None)
            return
    raise AssertionError(label)


@pytest.mark.parametrize("name", ["iiwa14", "panda", "xarm7"])
def test_solids_have_the_volume_of_the_shapes(arm, name):
    robot = arm(name)
    for solid, shape in zip(solids(robot), robot.collision_model.geometryObjects, strict=True):
        drawn = trimesh.Trimesh(solid.vertices, solid.faces)
        # A polygon of 32 sides has 0.64 % less area than its circle.
        assert drawn.volume == pytest.approx(shape.geometry.computeVolume(), rel=0.01)
        box = shape.geometry
        box.computeLocalAABB()
        ends = np.array([box.aabb_local.min_, box.aabb_local.max_])
        np.testing.assert_allclose(drawn.bounds, ends, atol=1e-6 + 0.005 * np.ptp(ends))


def test_spheres_and_boxes_of_an_own_robot(urdf):
    shapes = "".join(
        f'<collision><origin xyz="0.1 0 0"/><geometry>{kind}</geometry></collision>'
        for kind in ('<sphere radius="0.1"/>', '<box size="0.1 0.2 0.3"/>')
    )
    text = urdf.two_links().replace("</inertial></link>", f"</inertial>{shapes}</link>", 1)
    found = solids(urdf.load(text))
    volumes = [trimesh.Trimesh(one.vertices, one.faces).volume for one in found]
    assert [one.joint for one in found] == [1, 1]
    assert volumes == pytest.approx([4 / 3 * np.pi * 0.1**3, 0.006], rel=0.02)


def test_an_arm_without_shapes_is_drawn_with_bars(urdf):
    robot = urdf.load(urdf.two_links())
    reach = []
    for bar in solids(robot):
        corners = np.asarray(bar.vertices)
        reach += [np.linalg.norm(corners, axis=1).max()]
        assert bar.joint in (0, 1, 2)
    assert max(reach) == pytest.approx(np.hypot(0.3, THICKNESS), rel=1e-6)


def test_links_stand_where_pinocchio_places_them(viewer):
    robot = viewer.robot
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper)
    viewer.move(q)
    geometry = pin.GeometryData(robot.collision_model)
    pin.updateGeometryPlacements(
        robot.model, robot.model.createData(), robot.collision_model, geometry, q
    )
    assert len(viewer._links) == len(geometry.oMg)
    for link, at in zip(viewer._links, geometry.oMg, strict=True):
        np.testing.assert_allclose(link.position, at.translation, atol=1e-7)
        w, *xyz = link.wxyz
        np.testing.assert_allclose(pin.Quaternion(w, *xyz).matrix(), at.rotation, atol=1e-6)
    assert [slider.value for slider in viewer._sliders] == pytest.approx(list(q))


def test_a_slider_turns_the_joint_and_the_numbers_follow(viewer):
    robot, q = viewer.robot, viewer.q.copy()
    q[1] += 0.2
    viewer._sliders[1].value = q[1]
    np.testing.assert_allclose(viewer.q, q)
    inertia = hj.directional_inertia(robot, q, 6, [0, 1, 0])
    speed = hj.hitting_speed(robot, q, 6, [0, 1, 0], straight=True)
    flux = hj.hitting_flux(inertia, 2.0, speed)
    said = viewer._numbers.content
    assert f"| inertia | {inertia:.3f} | kg |" in said
    assert f"| greatest speed, straight | {speed:.3f} | m/s |" in said
    assert f"| greatest flux, straight | {flux:.3f} | m/s |" in said


def test_the_scale_of_the_surface_suits_the_inertia(viewer):
    scales = {}
    for joint in ("7", "5", "7"):
        viewer._joint.value = joint
        scales[joint] = float(re.search(r"10 cm = ([\d.]+) kg", viewer._numbers.content)[1])
    assert scales["7"] < scales["5"]
    viewer._joint.value = "4"  # on a sphere: along its radius the inertia has no end
    assert "cut at 20 cm" in viewer._numbers.content


def test_a_continuous_joint_may_be_turns_away(urdf):
    robot = urdf.load(urdf.two_links(kind="continuous", more='<limit velocity="2" effort="3"/>'))
    viewer = hj.view(robot, [0.5, 5.0], 2, port=PORT)
    try:
        np.testing.assert_allclose(viewer.q, [0.5, 5.0])
        shown = [slider.value for slider in viewer._sliders]
        assert shown == pytest.approx([0.5, 5.0 - 2 * np.pi])
        viewer._sliders[0].value = 0.6
        here = hj.position(robot, viewer.q, hj.Contact(2, (0.1, 0, 0)))
        np.testing.assert_allclose(here, hj.position(robot, [0.6, 5.0], hj.Contact(2, (0.1, 0, 0))))
    finally:
        viewer.stop()


def test_buttons(viewer):
    robot = viewer.robot
    press(viewer, "plan for inertia")
    best = hj.plan(robot, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, [6]).best
    assert best is not None
    np.testing.assert_allclose(viewer.q, best.q)
    press(viewer, "home")
    np.testing.assert_allclose(viewer.q, robot.home)
    press(viewer, "place the joint at the object")
    np.testing.assert_allclose(hj.position(robot, viewer.q, 6), [0.5, 0.3, 0.5], atol=1e-6)
    viewer._at.value = (0.5, 0.3, 3.0)
    press(viewer, "place the joint at the object")
    assert "comes no nearer than" in viewer._answer.content
    press(viewer, "plan for inertia")
    assert "unreachable" in viewer._answer.content


def test_the_hit_is_played_to_its_end(viewer, monkeypatch):
    shown = []
    monkeypatch.setattr(viewer, "move", shown.append)
    press(viewer, "hit, 10 times slower")
    result = hj.rollout(viewer.robot, hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3))
    np.testing.assert_array_equal(shown[0], result.rows["q"][0])
    assert len(shown) == len(result.rows["q"][::2])  # about 30 frames a second


def test_a_swing_is_played_from_where_the_arm_is(viewer, monkeypatch):
    shown, begun = [], viewer.q.copy()
    monkeypatch.setattr(viewer, "move", shown.append)
    monkeypatch.setattr("time.sleep", lambda _: None)
    press(viewer, "swing from here")
    made = hj.swing(viewer.robot, hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3), q0=begun)
    np.testing.assert_array_equal(shown[0], begun)
    assert len(shown) == len(made.times[::33])  # about 30 frames a second
    viewer._flux.value = 3.0
    press(viewer, "swing from here")
    assert "beyond the maximum" in viewer._answer.content


def test_a_direction_of_zero_is_told_and_nothing_breaks(viewer):
    viewer._along.value = (0.0, 0.0, 0.0)
    assert "direction" in viewer._numbers.content
    viewer._along.value = (0.0, 2.0, 0.0)
    assert "| inertia |" in viewer._numbers.content


def test_a_joint_that_cannot_move_is_told(viewer):
    viewer._joint.value = "1"
    assert "cannot move" in viewer._numbers.content


def test_it_is_served(viewer):
    page = urllib.request.urlopen(viewer.url, timeout=10).read()
    assert b"<html" in page.lower()


def test_command_writes_a_page(run, tmp_path):
    page = tmp_path / "arm.html"
    outcome = run("view", "--robot", "panda", "--joint", 7, "--out", page, "--json")
    assert outcome.code == 0
    assert outcome.json["joint"] == 7
    assert outcome.json["url"].startswith("http://127.0.0.1:")
    assert "<html" in page.read_text().lower()
    assert outcome.err == f"written: {page}\n"


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("ignored", [False, True])
def test_command_serves_until_a_signal(number, ignored):
    """Also when it starts with SIGINT ignored, as what a script runs in the background does."""
    words = [sys.executable, "-m", "hitjoints.cli", "view", "--port", str(PORT + 50), "--json"]
    ignore = "trap '' INT;" if ignored else ""
    words = ["sh", "-c", f"{ignore} exec {shlex.join(words)}"]
    with served(words) as it:
        found = json.loads(it.stdout.readline())
        page = urllib.request.urlopen(found["url"], timeout=10).read()
        it.send_signal(number)
        rest, said = it.communicate(timeout=20)
    assert b"<html" in page.lower()
    assert (it.returncode, rest) == (0, "")
    assert said == f"serving: {found['url']} until Ctrl-C\n"


@contextmanager
def served(words):
    """Run a server, and end it whatever becomes of the test."""
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen(words, text=True, **pipes) as it:
        late = threading.Timer(LIMIT, it.kill)
        late.start()
        try:
            yield it
        finally:
            late.cancel()
            it.kill()


@pytest.mark.parametrize(
    ("origin", "lets_in"),
    [
        (None, True),
        ("http://127.0.0.1:{port}", True),
        ("http://127.0.0.1:3000", False),
        ("http://localhost:{port}", False),  # this server was asked for as 127.0.0.1
        ("http://elsewhere.example", False),
        ("null", False),
        ("file://", False),
    ],
)
def test_pages_from_elsewhere_may_not_press_its_buttons(viewer, origin, lets_in):
    port = viewer.url.rpartition(":")[2]
    origin = origin and origin.format(port=port)
    if lets_in:
        with socket_of(viewer, origin) as socket:
            assert socket.recv(timeout=10)
    else:
        with pytest.raises(InvalidStatus, match="403"):
            socket_of(viewer, origin)


def socket_of(viewer, origin):
    address = viewer.url.replace("http", "ws")
    return connect(
        address, origin=origin, subprotocols=[f"viser-v{viser.__version__}"], max_size=None
    )


@pytest.mark.parametrize(
    ("origin", "asked", "served_as", "foreign"),
    [
        ("http://localhost:8080", "localhost:8080", "127.0.0.1", False),
        ("http://localhost:9000", "localhost:9000", "127.0.0.1", False),  # a forwarded port
        ("http://192.168.0.7:8080", "192.168.0.7:8080", "0.0.0.0", False),
        ("http://[::1]:8080", "[::1]:8080", "::", False),
        ("https://arm.lab", "arm.lab", "arm.lab", False),
        ("http://evil.example:8080", "evil.example:8080", "0.0.0.0", True),  # its name points here
        ("http://localhost:3000", "localhost:8080", "127.0.0.1", True),
        ("http://localhost:8080", None, "127.0.0.1", True),
        ("http://[", "[", "127.0.0.1", True),
        ("chrome-extension://abc", "abc", "127.0.0.1", True),
    ],
)
def test_which_pages_are_foreign(origin, asked, served_as, foreign):
    assert is_foreign(origin, asked, served_as) == foreign


@pytest.mark.parametrize("option", ["--mass", "--flux"])
@pytest.mark.parametrize("value", ["1e-5", "0.005", "1e9"])
def test_small_and_large_numbers_are_shown(run, tmp_path, option, value):
    outcome = run("view", option, value, "--out", tmp_path / "arm.html", "--json")
    assert outcome.code == 0
    assert outcome.json["joint"] == 6


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--q", "9,0,0,0,0,0,0"], "joint 1 is at 9, outside its limits"),
        (["--port", "0"], "port = 0: a port is from 1 to 65535"),
        (["--host", "no.such.host.invalid"], "host = no.such.host.invalid: "),
        (["--out", "arm.txt"], "out = arm.txt: the name must end in .html"),
        (["--joint", "8"], "joint = 8: iiwa14 has joints 1 to 7"),
        (["--direction", "0,0,0"], "direction"),
        (["--mass", "-1"], "mass = -1.0"),
    ],
)
def test_bad_input(run, arguments, words):
    outcome = run("view", *arguments)
    assert outcome.code == 1
    assert words in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert outcome.out == ""


def test_without_viser_the_install_line_is_told(arm, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(MissingExtraError, match=r"hitjoints\[view\]"):
        hj.view(arm("iiwa14"))


def test_configurations_outside_the_limits_are_refused(viewer):
    with pytest.raises(InputError, match="joint 4"):
        viewer.move([0, 0, 0, 3, 0, 0, 0])
    np.testing.assert_array_equal(viewer.q, viewer.robot.home)


def test_a_plan_is_shown_and_played(arm, monkeypatch):
    """A hit is played to the configuration that was planned, not to another that would do."""
    robot = arm("iiwa14")
    planned = hj.plan(robot, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, [6], flux=0.2, certificate=False)
    viewer = hj.view(planned, robot, port=PORT)
    try:
        np.testing.assert_array_equal(viewer.q, planned.best.q)
        shown = []
        monkeypatch.setattr(viewer, "move", shown.append)
        press(viewer, "hit, 10 times slower")
        result = hj.rollout(planned, robot)
        np.testing.assert_allclose(shown[0], result.rows["q"][0])
    finally:
        viewer.stop()
