"""Every figure of the project, in every size and file it can be saved as."""

import re
import zlib

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

import hitjoints as hj
from hitjoints.maps.winning_joint import winning_joint

PLACE, H, MASS = (0.5, 0.3, 0.5), (0.0, 1.0, 0.0), 2.0


@pytest.fixture(scope="module")
def results():
    """One small result of every kind, with the function that draws it."""
    robot = hj.load_robot("iiwa14")
    plan = hj.plan(robot, PLACE, H, MASS, certificate=False)
    hit = hj.Hit(position=PLACE, direction=H, mass=MASS, contact=hj.Contact(6), flux=0.3)
    grid = np.linspace(-0.6, 0.6, 5)
    found = winning_joint(robot, grid, grid, 0.5, H, MASS, times=[1e-3, 2e-2])
    swept = hj.sweep_workspace(robot, grid, grid, np.array([0.5]), [H], MASS, samples=3)
    times = np.geomspace(1e-4, 0.03, 5)
    fig = hj.figures
    swing = hj.swing(robot, hit)
    return {
        "arm": lambda **how: fig.arm(robot, plan.best.q, 6, H, (0.1, 0.1, 0.1), **how),
        "plan": lambda **how: fig.plan(plan, **how),
        "swing": lambda **how: fig.swing(swing, **how),
        "rollout": _drawn(fig.rollout, hj.rollout(robot, hit)),
        "simulation": _drawn(fig.simulation, hj.simulate(robot, hit)),
        "replay": _drawn(fig.replay, hj.replay(None)),
        "joint_sweep": _drawn(fig.joint_sweep, hj.sweep_joint(robot, PLACE, H, MASS, count=9)),
        "mass_sweep": _drawn(
            fig.mass_sweep, hj.sweep_mass(robot, PLACE, H, [0.5, 6.0], joints=[7])
        ),
        "contact_time_sweep": _drawn(
            fig.contact_time_sweep, hj.sweep_contact_time(robot, PLACE, H, MASS, times)
        ),
        "winning_joint": _drawn(fig.winning_joint, found),
        "workspace": lambda **how: fig.workspace(robot, swept, **how),
        "calibration": _drawn(fig.calibration, hj.calibrate(["tests/data/landing/object_2.csv"])),
        "answer": _drawn(fig.answer, _answer(robot, hit, plan, swing)),
    }


def _drawn(function, result):
    return lambda **how: function(result, **how)


def _answer(robot, hit, plan, swing):
    return hj.Answer(robot, hit, "sendable", "", plan, swing)


KINDS = (
    "arm", "plan", "swing", "rollout", "simulation", "replay", "joint_sweep", "mass_sweep",
    "contact_time_sweep", "winning_joint", "workspace", "calibration", "answer",
)  # fmt: skip


def test_every_public_figure_is_tested_here():
    assert set(hj.figures.__all__) == {*KINDS, "reproduction", "save"}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.filterwarnings("error:constrained_layout not applied:UserWarning")
def test_a_figure_has_the_size_asked_for_and_its_text_lies_in_it(results, kind, tmp_path):
    figure = results[kind](size="single")
    file = tmp_path / "figure.png"
    hj.figures.save(figure, file)
    assert imread(file).shape[1] == round(88.9 / 25.4 * 300)
    figure.draw_without_rendering()
    drawn = figure.get_window_extent()
    for axis in figure.axes:
        for text in (axis.title, axis.xaxis.label, axis.yaxis.label):
            box = text.get_window_extent()
            assert not text.get_text() or (box.x0 > -2 and box.x1 < drawn.x1 + 2), text
            assert not text.get_text() or (box.y0 > -2 and box.y1 < drawn.y1 + 2), text
    wide = results[kind](size=(150, 70))
    assert wide.get_size_inches() * 25.4 == pytest.approx((150, 70))


@pytest.mark.parametrize("kind", KINDS)
def test_the_main_panel_is_drawn_on_an_axis_that_is_given(results, kind):
    figure = Figure()
    axis, other = figure.subplots(1, 2)
    before = len(other.get_children())
    assert results[kind](ax=axis) is figure
    assert axis.has_data()
    assert len(other.get_children()) == before
    with pytest.raises(hj.InputError, match="own look"):
        results[kind](ax=axis, size="single")


@pytest.mark.parametrize("kind", KINDS)
def test_every_axis_tells_its_unit(results, kind):
    for axis in results[kind]().axes:
        for label in (axis.get_xlabel(), axis.get_ylabel()):
            shares = re.search("limit|from the line", label)
            assert not label or "(" in label or shares, label


@pytest.mark.parametrize("kind", ["plan", "swing", "joint_sweep", "workspace"])
def test_a_pdf_holds_truetype_fonts_and_no_type_3(results, kind, tmp_path):
    file = tmp_path / "figure.pdf"
    hj.figures.save(results[kind](), file)
    read = file.read_bytes()
    streams = re.findall(rb"stream\r?\n(.*?)\r?\nendstream", read, re.DOTALL)
    for stream in streams:
        try:
            read += zlib.decompress(stream)
        except zlib.error:
            continue
    assert b"/Type3" not in read
    assert b"/CIDFontType2" in read  # TrueType in a Type 0 font: what Type 42 is in a PDF


def test_an_svg_keeps_its_text_and_the_same_figure_is_the_same_file(results, tmp_path):
    files = [tmp_path / name for name in ("a.svg", "b.svg", "a.pdf", "b.pdf")]
    for file in files:
        hj.figures.save(results["joint_sweep"](), file)
    assert ">joint 5<" in files[0].read_text()
    assert files[0].read_bytes() == files[1].read_bytes()
    assert files[2].read_bytes() == files[3].read_bytes()


def test_font_and_style_are_kept(results, tmp_path):
    style = tmp_path / "mine.mplstyle"
    style.write_text("font.family: DejaVu Serif\nfigure.figsize: 4, 3\nlines.linewidth: 7\n")
    figure = results["mass_sweep"](style=style)
    (axis,) = figure.axes
    assert axis.xaxis.label.get_fontname() == "DejaVu Serif"
    assert tuple(figure.get_size_inches()) == (4, 3)
    assert axis.lines[-1].get_linewidth() >= 1
    figure = results["mass_sweep"](style=style, font="DejaVu Sans Mono", size="90x50")
    assert figure.axes[0].xaxis.label.get_fontname() == "DejaVu Sans Mono"
    assert figure.get_size_inches()[0] == pytest.approx(90 / 25.4)


def test_the_users_matplotlibrc_goes_before_ours(results):
    import matplotlib as mpl

    with mpl.rc_context(
        {"axes.spines.top": True, "legend.frameon": False, "figure.figsize": (5, 4)}
    ):
        figure = results["mass_sweep"]()
    assert tuple(figure.get_size_inches()) == (5, 4)
    before = dict(mpl.rcParams)
    results["mass_sweep"](size="single", font="serif")
    assert dict(mpl.rcParams) == before


@pytest.mark.parametrize(
    ("look", "words"),
    [
        ({"size": "triple"}, "size = triple: single, double, or WIDTHxHEIGHT in mm"),
        ({"size": "5x5"}, "edges from 20 to 2000 mm"),
        ({"size": (90, float("nan"))}, "edges from 20 to 2000 mm"),
        ({"size": 90}, "WIDTHxHEIGHT"),
        ({"font": "DejaVu Sanz"}, "did you mean DejaVu Sans"),
        ({"style": "nowhere.mplstyle"}, "a file .mplstyle"),
    ],
)
def test_a_look_that_cannot_be_had_is_refused(results, look, words):
    with pytest.raises(hj.InputError, match=re.escape(words)):
        results["mass_sweep"](**look)


def test_a_style_that_is_no_text_is_refused(results, tmp_path):
    style = tmp_path / "bad.mplstyle"
    style.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(hj.InputError, match="style"):
        results["mass_sweep"](style=style)


def test_a_notebook_shows_a_figure(results):
    assert results["mass_sweep"]()._repr_png_().startswith(b"\x89PNG")


def test_results_draw_themselves():
    robot = hj.load_robot("iiwa14")
    plan = hj.plan(robot, PLACE, H, MASS, certificate=False)
    assert len(plan.plot(size="double").axes) == 2
    axis = Figure().add_subplot()
    assert plan.plot(axis) is axis.figure
    assert axis.get_ylabel() == r"directional inertia $\lambda_h$ (kg)"
