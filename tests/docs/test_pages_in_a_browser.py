"""The pages in a real browser, by light and in the dark, on a desk and on a telephone."""

import pytest

from tests.show.chromium import chromium, program

pytestmark = pytest.mark.skipif(program() is None, reason="chromium is not installed")
WIDTHS = (390, 1280)
TOO_WIDE = """(() => {
  const room = document.documentElement.clientWidth, scrolls = ['auto', 'scroll', 'hidden'];
  const within = one => one && one !== document.body &&
    (scrolls.includes(getComputedStyle(one).overflowX) || within(one.parentElement));
  const wide = [...document.querySelectorAll('article *')].filter(
    one => one.getBoundingClientRect().right > room + 1 && !within(one));
  if (document.documentElement.scrollWidth > room) wide.push(document.body);
  return wide.slice(0, 3).map(one => one.tagName + ': ' + one.textContent.slice(0, 60)); })()"""
# How far text stands out from its ground, WCAG's ratio.
CONTRAST = """(() => {
  const parts = text => text.match(/[\\d.]+/g).map(Number);
  const light = ([r, g, b]) => [r, g, b].map(v => v / 255).map(
    v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4
  ).reduce((sum, v, i) => sum + v * [0.2126, 0.7152, 0.0722][i], 0);
  const style = getComputedStyle(document.querySelector('article p'));
  const ground = getComputedStyle(document.body).backgroundColor;
  const [a, b] = [light(parts(style.color)), light(parts(ground))].sort((x, y) => y - x);
  return (a + 0.05) / (b + 0.05); })()"""


@pytest.fixture(scope="module")
def tab():
    with chromium() as made:
        yield made()


def test_no_page_is_wider_than_the_screen(built, tab):
    for page in sorted(built.glob("*.html")):
        tab.open(page.as_uri())
        tab.wait(f"document.readyState === 'complete' && location.href === '{page.as_uri()}'")
        for width in WIDTHS:
            for dark in (False, True):
                tab.size(width, 800, phone=width < 500, dark=dark)
                assert tab.run(TOO_WIDE) == [], (page.name, width)
                if tab.run("document.querySelector('article p') !== null"):
                    assert tab.run(CONTRAST) > 7, (page.name, dark)
    assert tab.errors == []
    assert all(address.startswith("file:") for address in tab.requests)


def test_what_is_too_wide_is_found(tab):
    tab.open("data:text/html,<article><p style='width: 3000px'>wide</p></article>")
    tab.wait("document.querySelector('p') !== null")
    assert tab.run(TOO_WIDE)[0] == "P: wide"
