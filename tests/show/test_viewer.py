"""The viewer's server: what it draws and says, and what its controls do."""

import sys
import urllib.request

import numpy as np
import pinocchio as pin
import pytest
import viser
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

import hitjoints as hj
from hitjoints.errors import InputError, MissingExtraError
from hitjoints.show.drawn_arm import rgb
from hitjoints.show.viewer.drawing import RED
from hitjoints.show.viewer.origin import is_foreign

PORT = 18_080


@pytest.fixture
def viewer(arm):
    made = hj.view(arm("iiwa14"), port=PORT)
    yield made
    made.stop()


def press(viewer, label):
    """Do what a click in the browser does, and what it asks for."""
    for handle in viewer._server.gui._gui_input_handle_from_uuid.values():
        if getattr(handle, "label", None) == label:
            for callback in handle._impl.update_cb:
                callback(None)
            assert viewer.wait(60)
            return
    raise AssertionError(label)


def drag(viewer, handle, to):
    """Do what dragging a handle does."""
    handle._impl.position = np.array(to, dtype=float)
    for callback in handle._impl_aux.update_cb:
        callback(type("Event", (), {"target": handle}))
    assert viewer.wait(60)


def answer(viewer):
    return viewer._panel._answer.content


def test_links_stand_where_pinocchio_places_them(viewer):
    robot = viewer.robot
    q = np.random.default_rng(0).uniform(robot.lower, robot.upper)
    viewer.move(q)
    geometry = pin.GeometryData(robot.collision_model)
    pin.updateGeometryPlacements(
        robot.model, robot.model.createData(), robot.collision_model, geometry, q
    )
    links = viewer._drawing._links
    assert len(links) == len(geometry.oMg)
    for link, at in zip(links, geometry.oMg, strict=True):
        np.testing.assert_allclose(link.position, at.translation, atol=1e-7)
        w, *xyz = link.wxyz
        np.testing.assert_allclose(pin.Quaternion(w, *xyz).matrix(), at.rotation, atol=1e-6)
    assert [slider.value for slider in viewer._panel.sliders] == pytest.approx(list(q))


def test_a_slider_turns_the_joint_and_the_numbers_follow(viewer):
    robot, q = viewer.robot, viewer.q.copy()
    q[1] += 0.2
    viewer._panel.sliders[1].value = q[1]
    np.testing.assert_allclose(viewer.q, q)
    inertia = hj.directional_inertia(robot, q, 6, [0, 1, 0])
    speed = hj.hitting_speed(robot, q, 6, [0, 1, 0], straight=True)
    flux = hj.hitting_flux(inertia, 2.0, speed)
    said = viewer._panel._here.content
    for number in (inertia, speed, flux):
        assert f">{number:.3f}</td>" in said
    assert viewer._drawing._said.text == f"joint 6: {inertia:.2f} kg"


def test_the_scale_of_the_surface_suits_the_inertia(viewer):
    scales = {}
    for joint in ("7", "5", "7"):
        viewer._panel.hit.joint.value = joint
        scales[joint] = float(viewer._drawing.scale.split("10 cm = ")[1].split()[0])
    assert scales["7"] < scales["5"]
    viewer._panel.hit.joint.value = "4"  # on a sphere: along its radius the inertia has no end
    assert "cut at 20 cm" in viewer._panel._here.content


def test_a_continuous_joint_may_be_turns_away(urdf):
    robot = urdf.load(urdf.two_links(kind="continuous", more='<limit velocity="2" effort="3"/>'))
    viewer = hj.view(robot, [0.5, 5.0], 2, port=PORT)
    try:
        np.testing.assert_allclose(viewer.q, [0.5, 5.0])
        sliders = viewer._panel.sliders
        assert [slider.value for slider in sliders] == pytest.approx([0.5, 5.0 - 2 * np.pi])
        sliders[0].value = 0.6
        here = hj.position(robot, viewer.q, hj.Contact(2, (0.1, 0, 0)))
        np.testing.assert_allclose(here, hj.position(robot, [0.6, 5.0], hj.Contact(2, (0.1, 0, 0))))
    finally:
        viewer.stop()


def test_buttons(viewer):
    robot = viewer.robot
    press(viewer, "plan")
    best = hj.plan(
        robot, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, [6], flux=0.3, deliverable=True, certificate=False
    ).best
    np.testing.assert_allclose(viewer.q, best.q, atol=1e-9)
    assert f"{best.inertia:.3g}" in viewer._panel._candidates.content
    press(viewer, "home")
    np.testing.assert_allclose(viewer.q, robot.home)
    press(viewer, "place the joint at the object")
    np.testing.assert_allclose(hj.position(robot, viewer.q, 6), [0.5, 0.3, 0.5], atol=1e-6)


def test_what_cannot_be_is_told(viewer):
    viewer._panel.hit.by_itself.value = False
    viewer._panel.hit.position.value = (0.5, 0.3, 3.0)
    press(viewer, "place the joint at the object")
    assert "comes no nearer than" in answer(viewer)
    press(viewer, "play")
    assert "plan first" in answer(viewer)
    press(viewer, "plan")
    assert "unreachable" in viewer._panel._candidates.content
    viewer._panel.hit.direction.value = (0.0, 0.0, 0.0)
    assert "direction" in answer(viewer)
    viewer._panel.hit.direction.value = (0.0, 2.0, 0.0)
    assert answer(viewer) == ""


def test_a_joint_that_cannot_move_is_told(viewer):
    viewer._panel.hit.joint.value = "1"
    assert "cannot move" in viewer._panel._here.content
    assert "cannot move" in viewer._drawing._said.text


def test_to_look_is_not_to_plan(viewer):
    """Nothing is planned until it is asked for."""
    viewer._panel.hit.joint.value = "7"
    viewer._panel.sliders[0].value = 0.1
    viewer.move(viewer.robot.home)
    assert viewer.wait(5)
    assert viewer.stage.plan is None


def test_what_is_dragged_is_planned_for(viewer):
    drag(viewer, viewer._handles._object, (0.45, 0.25, 0.5))
    first = viewer.stage.plan
    np.testing.assert_allclose(first.position, (0.45, 0.25, 0.5))
    np.testing.assert_array_equal(viewer.q, viewer.stage.candidate.q)
    viewer._panel.hit.way.value = "goal"
    assert viewer.wait(60)
    drag(viewer, viewer._handles._aim, (0.6, 0.4, 0.9))
    second = viewer.stage.plan
    np.testing.assert_allclose(viewer.stage.wish.goal, (0.6, 0.4, 0.5))
    np.testing.assert_allclose(second.direction, np.array((1, 1, 0)) / np.sqrt(2), atol=1e-9)
    assert second != first


def test_what_is_dragged_on_is_not_put_back(viewer):
    """The browser is ahead: it moves a handle again while the last move is still being drawn."""
    viewer._panel.hit.way.value = "goal"
    assert viewer.wait(60)
    handle = viewer._handles._aim
    show_all, seen = viewer._show_all, []

    def slowly():
        handle._impl.position = np.array((0.6, 0.5, 0.5))  # meanwhile
        show_all()
        seen.append(np.array(handle.position))

    viewer._show_all = slowly
    drag(viewer, handle, (0.55, 0.5, 0.5))
    viewer._show_all = show_all
    assert all(place.tolist() == [0.6, 0.5, 0.5] for place in seen)
    drag(viewer, handle, (0.6, 0.5, 0.5))
    np.testing.assert_allclose(viewer.stage.wish.goal, (0.6, 0.5, 0.5))


def test_a_plan_is_shown_and_not_made_again(arm, monkeypatch):
    robot = arm("iiwa14")
    planned = hj.plan(robot, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, [6], flux=0.2, certificate=False)
    monkeypatch.setattr("hitjoints.show.viewer.making.plan", None)
    viewer = hj.view(planned, robot, port=PORT)
    try:
        assert viewer.stage.plan is planned
        np.testing.assert_array_equal(viewer.q, planned.best.q)
        viewer.make("rollout")
        result = hj.rollout(planned, robot)
        np.testing.assert_allclose(viewer.stage.clip.q, result.rows["q"])
        np.testing.assert_allclose(viewer.q, result.rows["q"][0])
    finally:
        viewer.stop()


@pytest.mark.parametrize("kind", ["swing", "rollout"])
def test_a_motion_is_played_to_its_end(arm, kind):
    robot = arm("iiwa14")
    hit = hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3)
    made = getattr(hj, kind)(robot, hit)
    rows = made.joints.q if kind == "swing" else made.rows["q"]
    viewer = hj.view(made, port=PORT)
    try:
        assert viewer.stage.clip.kind == kind
        begin = np.array(viewer._drawing._box.position)
        viewer.scrub(viewer.stage.clip.impact_time / 2)
        np.testing.assert_array_equal(viewer._drawing._box.position, begin)
        viewer.set_speed(100.0)
        viewer.play_or_pause()
        for _ in range(200):
            if not viewer._timeline.plays:
                break
            viewer._timeline._over.wait(0.05)
        np.testing.assert_allclose(viewer.q, rows[-1], atol=1e-12)
        way = np.array(viewer._drawing._box.position) - begin
        assert way[1] > 0.02
        np.testing.assert_allclose(begin + way, viewer.stage.box.centre, atol=1e-12)
    finally:
        viewer.stop()


def test_limits_are_red(viewer):
    q = viewer.robot.home.copy()
    q[3] = viewer.robot.lower[3]
    viewer.move(q)
    red = tuple(round(255 * c) for c in rgb(RED))
    drawing = viewer._drawing
    colours = {
        joint: link.color
        for (joint, _), link in zip(drawing._carriers, drawing._links, strict=True)
    }
    assert colours[4] == red
    assert colours[3] != red
    viewer.move(viewer.robot.home)
    assert drawing._links[-1].color != red
    assert all(link.color != red for link in drawing._links)


def test_where_the_box_stops_is_drawn(viewer):
    press(viewer, "plan")
    found, _ = viewer.stage.rest
    scene = viewer._server.scene
    mark = scene.get_handle_by_name("/landing")
    np.testing.assert_allclose(
        mark.position[:2],
        found.mean[:2] + (viewer.stage.begin.centre - (0.5, 0.3, 0.5))[:2],
        atol=1e-9,
    )
    spread = np.sqrt(np.linalg.eigvalsh(found.covariance).max())
    assert np.abs(mark.vertices[:, 1]).max() == pytest.approx(max(2 * spread, 0.01), rel=1e-3)


def test_a_page_says_and_plays_what_is_shown(arm):
    planned = hj.plan(
        arm("iiwa14"), [0.5, 0.3, 0.5], [0, 1, 0], 2.0, [6, 7], flux=0.2, certificate=False
    )
    viewer = hj.view(planned, arm("iiwa14"), port=PORT)
    try:
        still = viewer.as_html()
        viewer.make()
        viewer.scrub(0.7)
        moving = viewer.as_html()
        assert viewer.stage.time == 0.7
    finally:
        viewer.stop()
    for page in (still, moving):
        assert f"{planned.best.inertia:.3g}" in page
        assert "2 kg at (0.5, 0.3, 0.5) m" in page
    assert "can be sent" in moving
    assert len(moving) > len(still) + 10_000


def test_it_is_served(viewer):
    page = urllib.request.urlopen(viewer.url, timeout=10).read()
    assert b"<html" in page.lower()


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


def test_without_viser_the_install_line_is_told(arm, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    with pytest.raises(MissingExtraError, match=r"hitjoints\[view\]"):
        hj.view(arm("iiwa14"))


def test_configurations_outside_the_limits_are_refused(viewer):
    with pytest.raises(InputError, match="joint 4"):
        viewer.move([0, 0, 0, 3, 0, 0, 0])
    np.testing.assert_array_equal(viewer.q, viewer.robot.home)


def test_what_is_typed_or_turned_on_is_not_pulled_back(viewer):
    """The browser is ahead of what is drawn, by a digit or by a part of a turn."""
    mass, slider = viewer._panel.hit.mass, viewer._panel.sliders[0]
    for control, first, then in ((mass, 1.0, 1.5), (slider, 0.4, 0.5)):
        draw, calls = viewer._drawing.moment, []

        def slowly(control=control, then=then, draw=draw, calls=calls):
            control._impl.value = then  # meanwhile
            calls.append(draw())

        viewer._drawing.moment = slowly
        control.value = first
        viewer._drawing.moment = draw
        assert calls
        assert control.value == then
    viewer._worker.stop()


def test_a_change_pauses_and_play_goes_on(arm):
    robot = arm("iiwa14")
    made = hj.swing(robot, hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3))
    viewer = hj.view(made, port=PORT)
    try:
        viewer.set_speed(1e-3)
        viewer.play_or_pause()
        assert viewer._panel.play.label == "pause"
        assert not viewer._handles._object.visible
        viewer._panel.sliders[0].value = 0.5
        assert not viewer._timeline.plays
        assert viewer._panel.play.label == "play"
        assert viewer._handles._object.visible
        assert viewer.stage.clip is not None
        viewer.play_or_pause()
        viewer.play_or_pause()
        assert viewer._panel.play.label == "play"
        viewer._panel.hit.by_itself.value = False
        viewer._panel.hit.mass.value = 1.0
        assert viewer.stage.clip is None
    finally:
        viewer.stop()
