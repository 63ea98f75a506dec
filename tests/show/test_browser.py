"""The viewer in a real browser, Chromium without a screen; skipped where there is none."""

import io
import json
import time

import numpy as np
import pytest
from matplotlib.image import imread

import hitjoints as hj
from hitjoints.show.viewer.viewpoint import FIELD
from tests.show.chromium import chromium, program

pytestmark = pytest.mark.skipif(
    program() is None, reason="there is no chromium: .ci/browser installs one"
)
PORT = 18_200
SIZE = 640, 300  # small: every picture is drawn by the processor
HIT = {"restitution": 0.5, "friction": 0.06, "size": (0.16, 0.24, 0.16)}
NUMBERS = """[...document.querySelectorAll('tr')].map(
  row => [...row.cells].map(cell => cell.innerText.trim()))"""


@pytest.fixture(scope="module")
def browser():
    with chromium() as tab:
        yield tab


@pytest.fixture
def tab(browser):
    made = browser()
    made.size(*SIZE)
    yield made
    made.close()


@pytest.fixture(scope="module")
def plan():
    robot = hj.load_robot("iiwa14")
    hit = hj.Hit(6, [0.5, 0.3, 0.5], [0, 1, 0], 2.0, 0.3, **HIT)
    found = hj.plan(robot, hit.position, hit.direction, 2.0, [6, 7], flux=0.3, certificate=False)
    return hit, found


@pytest.fixture
def viewer(plan):
    hit, found = plan
    made = hj.view(hit, hj.load_robot("iiwa14"), port=PORT)
    made.change(lambda: made.stage.adopt(found), plans=False)
    yield made
    made.stop()


def opened(tab, viewer):
    """Open the viewer, and wait until its panel is there and its scene has come."""
    tab.open(viewer.url)
    tab.wait("document.querySelector('canvas') !== null")
    tab.wait("document.querySelector('td') !== null")
    hide_notices(tab)


def hide_notices(tab):
    """Hide what the viewer says of a browser that draws without a graphics card."""
    style = "<style>.mantine-Notifications-root { display: none }</style>"
    tab.run(f"document.head.insertAdjacentHTML('beforeend', {json.dumps(style)})")


def until(true, limit=30):
    """Wait until something is so, for so many seconds at most."""
    end = time.monotonic() + limit
    while not true():
        assert time.monotonic() < end
        time.sleep(0.1)


def box_at(tab, limit=60):
    """Return the middle of what is orange, the box, as a share of the width, once it is seen."""
    end = time.monotonic() + limit
    while True:
        red, green, blue = np.moveaxis(imread(io.BytesIO(tab.picture()))[..., :3], -1, 0)
        orange = (red - blue > 0.35) & (red > green + 0.08) & (green > blue + 0.12)
        if orange.sum() > 50:
            return np.nonzero(orange)[1].mean() / orange.shape[1]
        assert time.monotonic() < end, "no box is seen"
        time.sleep(0.5)


def test_it_loads_without_errors_and_asks_nobody_else(tab, viewer):
    opened(tab, viewer)
    rows = tab.run(NUMBERS)
    best = viewer.stage.candidate
    assert ["inertia kg", f"{best.inertia:.3g}"] == rows[2][:2]
    assert tab.errors == []
    served = viewer.url, viewer.url.replace("http", "ws")
    assert all(address.startswith(served) for address in tab.requests), tab.requests


def test_a_slider_moves_the_arm_and_the_inertia_shown_is_the_apis(tab, viewer):
    opened(tab, viewer)
    before, seen = viewer.q.copy(), tab.picture()
    tab.click("Joints")
    track = """(() => { const label = [...document.querySelectorAll('*')].find(
        one => one.tagName === 'LABEL' && one.textContent.trim() === 'q2');
      let row = label; let slider = null;
      while (!slider) {
        row = row.parentElement; slider = row.querySelector('.mantine-Slider-root'); }
      slider.scrollIntoView({block: 'center'});
      const box = slider.getBoundingClientRect();
      return [box.x, box.y + box.height / 2, box.width]; })()"""
    tab.run(track)
    time.sleep(0.3)
    x, y, width = tab.run(track)
    tab.drag((x + 0.5 * width, y), (x + 0.55 * width, y), steps=2)
    until(lambda: viewer.q[1] != before[1])
    until(lambda: viewer.wait(1) and tab.picture() != seen)
    assert viewer.q[1] == pytest.approx(0.1 * viewer.robot.upper[1], abs=0.1)
    np.testing.assert_array_equal(np.delete(viewer.q, 1), np.delete(before, 1))
    tab.click("Numbers")
    inertia = hj.directional_inertia(viewer.robot, viewer.q, 6, (0, 1, 0))
    wanted = json.dumps(f"{inertia:.3f}")
    tab.wait(f"({NUMBERS}).some(row => row[0] === 'inertia' && row[1] === {wanted})")
    assert tab.errors == []


def on_screen(viewer, point):
    """Return where a point (3,) m of the scene is seen, in pixels."""
    (client,) = viewer._server.get_clients().values()
    eye, at = np.array(client.camera.position), np.array(client.camera.look_at)
    ahead = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(ahead, (0, 0, 1))
    right /= np.linalg.norm(right)
    up = np.cross(right, ahead)
    way = np.asarray(point) - eye
    scale = SIZE[1] / 2 / np.tan(FIELD / 2) / (way @ ahead)
    return SIZE[0] / 2 + scale * (way @ right), SIZE[1] / 2 - scale * (way @ up)


def test_the_mouse_drags_the_goal_and_the_plan_follows(tab, viewer):
    viewer.change(lambda: viewer.stage.aim_at((0.5, 0.45)))
    assert viewer.wait(60)
    first = viewer.stage.plan
    opened(tab, viewer)
    goal = viewer.stage.wish.goal
    along = np.array((0.1, 0, 0))  # so far from its middle lies the shaft of a handle's arrow
    box_at(tab)  # the scene is there
    tab.drag(on_screen(viewer, goal + along), on_screen(viewer, goal + 2 * along))
    until(lambda: viewer.stage.wish.goal[0] > goal[0] + 0.03)
    assert viewer.stage.wish.goal[1:] == pytest.approx(goal[1:], abs=1e-3)
    until(lambda: viewer.wait(1) and viewer.stage.is_planned, 60)
    second = viewer.stage.plan
    assert second is not first
    np.testing.assert_allclose(second.direction, viewer.stage.wish.direction, atol=1e-9)
    best = f"{viewer.stage.plan.candidates[1].inertia:.3g}"
    tab.wait(f"({NUMBERS}).some(row => row[0] === 'inertia kg' && row.includes('{best}'))")
    assert tab.errors == []


def test_play_moves_the_box(tab, viewer):
    opened(tab, viewer)
    begin = box_at(tab)
    tab.click("play")
    until(lambda: viewer.stage.clip is not None and viewer.stage.time > 0)
    until(lambda: viewer.stage.time == viewer.stage.clip.duration, 60)
    tab.wait("[...document.querySelectorAll('button')].some(one => one.innerText === 'play')")
    time.sleep(0.5)
    assert box_at(tab) - begin > 0.015  # the hit crosses the picture to the right
    assert (viewer.stage.box.centre - viewer.stage.begin.centre)[1] > 0.1
    assert tab.errors == []


def test_a_page_plays_from_its_file_without_a_network(tab, viewer, tmp_path):
    viewer.make("rollout")
    page = tmp_path / "page.html"
    page.write_text(viewer.as_html(), encoding="utf-8")
    viewer.stop()
    tab.call("Network.emulateNetworkConditions", offline=True, latency=0,
             downloadThroughput=-1, uploadThroughput=-1)  # fmt: skip
    tab.open(page.as_uri())
    tab.wait("document.querySelector('input.mantine-NumberInput-input') !== null")
    hide_notices(tab)
    said = tab.run("document.getElementById('hitjoints').innerText")
    assert "2 kg at (0.5, 0.3, 0.5) m" in said
    scrub = """(() => { const input = document.querySelector('input.mantine-NumberInput-input');
      const set = Object.getOwnPropertyDescriptor(HTMLInputElement.prototype, 'value').set;
      set.call(input, TIME); input.dispatchEvent(new Event('input', {bubbles: true})); })()"""

    def seen_at(moment):
        tab.run(scrub.replace("TIME", f"'{moment:.1f}'"))
        time.sleep(1)
        return box_at(tab)

    # A page that is just there may still be at a time of its own.
    until(
        lambda: seen_at(viewer.stage.clip.duration / viewer._timeline.speed) - seen_at(0.1) > 0.015
    )
    assert tab.errors == []
    assert tab.requests == [page.as_uri()]
