"""The paper's experiments: every printed number has its row, and the rows are right."""

import csv
import math
import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import hitjoints as hj
from hitjoints.evidence.paper.claim_rows import ClaimRow
from hitjoints.evidence.paper.many import along_the_line, best_postures
from hitjoints.evidence.paper.scenario import Scenario
from hitjoints.evidence.paper.spread import study_spread
from hitjoints.evidence.paper.table import as_csv, as_markdown, shown
from hitjoints.evidence.paper.variants import VARIANTS, phantom_robot
from hitjoints.hitting.step import Gains
from hitjoints.show.paper_figures import draw_reproduction
from hitjoints.show.sheet import save_figure
from hitjoints.show.style import Look

H = np.array([0.0, 1.0, 0.0])
OBJECT = np.array([0.5, 0.3, 0.5])
# What the paper prints, and words of the row that has it.
PRINTED = [
    ("fig2", "mass of the object", 2.0),
    ("fig2", "joints of the arm", 7),
    ("fig2", "joints by their greatest flux", "6 > 7"),
    ("fig2", "flux, joint 5 / joint 7", "relatively strong"),
    ("fig4", "joint 7: RMS between", "almost the same"),
    ("fig4", "W weighs", 7),
    ("fig5", "h . (chi_7 - chi_6)", "< 0"),
    ("fig6", "joint 7: inertia at the impact (kg)", 2.5),
    ("fig6", "joint 6: inertia at the impact (kg)", 3.9),
    ("fig6", "joint 6 more than joint 7", 56.0),
    ("spread", "joint 6: greatest inertia by Eq. 14", "quite sensitive"),
    ("text", "joint 4: rank", "a sphere"),
    ("text", "joint 5: rank", "tangential only"),
]


@pytest.fixture(scope="module")
def row(reproduction):
    """Find the one row of a figure whose quantity holds some words."""

    def find(figure, words):
        (found,) = (r for r in reproduction.rows if r.figure == figure and words in r.quantity)
        return found

    return find


def model_position(robot, q, joint):
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, np.asarray(q, dtype=float))
    return data.oMi[joint].translation.copy()


def difference_jacobian(robot, q, joint, step=1e-6):
    """Return J by central differences of the forward kinematics, accurate to about 1e-10."""
    columns = [
        (model_position(robot, q + e, joint) - model_position(robot, q - e, joint)) / (2 * step)
        for e in step * np.eye(robot.n)
    ]
    return np.array(columns).T


def dense_inverse(robot, q, joint):
    """Return J M^-1 J^T with a dense inverse."""
    M = pin.crba(robot.model, robot.model.createData(), np.asarray(q, dtype=float))
    J = difference_jacobian(robot, q, joint)
    return J @ np.linalg.inv(M) @ J.T


def dense_inertia(robot, q, joint):
    return 1 / (H @ dense_inverse(robot, q, joint) @ H)


@pytest.mark.parametrize(("figure", "words", "printed"), PRINTED)
def test_every_printed_number_has_its_row(row, figure, words, printed):
    found = row(figure, words)
    assert found.paper == printed
    assert found.remark


def test_rows_are_numbers_or_short_words_and_every_remark_is_a_sentence(reproduction):
    assert len({(r.figure, r.quantity) for r in reproduction.rows}) == len(reproduction.rows)
    for r in reproduction.rows:
        for name in VARIANTS:
            value = getattr(r, name)
            if value is None:  # no setup of the phantom is near the printed number
                assert (name, r.figure) == ("iiwa14_phantom", "spread")
            elif isinstance(value, str):
                assert len(value) < 20
            else:
                assert math.isfinite(value), r
        assert r.remark.endswith("."), r
        assert "{" not in r.remark


def test_differences_from_printed_numbers_are_not_called_agreement(reproduction):
    for r in reproduction.rows:
        if isinstance(r.paper, float) and abs(r.iiwa14_bullet / r.paper - 1) > 0.02:
            assert not r.remark.startswith("As "), r


@pytest.mark.parametrize("name", VARIANTS)
@pytest.mark.parametrize("joint", [5, 6, 7])
def test_inertia_at_the_impact_is_the_dense_one(reproduction, row, name, joint):
    on = reproduction.experiments[name]
    q = on.hits.shown(joint).impact.q
    assert np.linalg.norm(model_position(on.robot, q, joint) - OBJECT) < 1e-3
    assert ((q >= on.robot.lower) & (q <= on.robot.upper)).all()
    found = getattr(row("fig6", f"joint {joint}: inertia at the impact (kg)"), name)
    assert found == pytest.approx(dense_inertia(on.robot, q, joint), rel=1e-7)
    if joint > 5:
        held = getattr(row("fig6", f"joint {joint}: h^T Lambda h"), name)
        expected = H @ np.linalg.inv(dense_inverse(on.robot, q, joint)) @ H
        assert held == pytest.approx(expected, rel=1e-6)


def test_ratio_follows_from_the_kilograms(row):
    seven, six = (row("fig6", f"joint {k}: inertia at the impact (kg)") for k in (7, 6))
    more, rebound = row("fig6", "joint 6 more than joint 7"), row("fig6", "(Eq. 11)")
    for name in VARIANTS:
        ratio = getattr(six, name) / getattr(seven, name)
        assert getattr(more, name) == pytest.approx(100 * (ratio - 1))
        # Eq. 11 with the speed that Eq. 4 asks for the flux: (1 + eps) m / lambda phi.
        changes = [hj.rebound(getattr(r, name), 2.0, hj.required_speed(getattr(r, name), 2.0, 0.3),
                              0.5) for r in (six, seven)]  # fmt: skip
        assert getattr(rebound, name) == pytest.approx(changes[0] / changes[1])


@pytest.mark.parametrize("name", VARIANTS)
def test_fig2_by_hand(reproduction, row, name):
    """The flux from a dense inertia and the sum of |J^T h| limits; Eq. 9's box optimum."""
    on = reproduction.experiments[name]
    robot, most = on.robot, {}
    for k in (5, 6, 7):
        turn = on.turn.sel(joint=k)
        q = np.array(turn.q.values)
        speed = np.abs(H @ difference_jacobian(robot, q, k)) @ robot.velocity_upper
        assert getattr(row("fig2", f"joint {k}: maximum hitting speed"), name) == pytest.approx(
            speed
        )
        inertias = []
        for angle in turn.angle.values[::20]:
            q[k - 1] = angle
            inertias.append(dense_inertia(robot, q, k))
        np.testing.assert_allclose(turn.inertia.values[::20], inertias, rtol=1e-7)
        most[k] = turn.flux.values.max()
        expected = speed * turn.inertia.values.max() / (turn.inertia.values.max() + 2)
        assert most[k] == pytest.approx(expected)
    order = " > ".join(map(str, sorted(most, key=most.get, reverse=True)))
    assert getattr(row("fig2", "joints by their greatest flux"), name) == order
    assert getattr(row("fig2", "flux, joint 6 / joint 7"), name) == pytest.approx(most[6] / most[7])
    wrong = getattr(row("fig2", "Eq. 10 as printed"), name)
    assert wrong > getattr(row("fig2", "joint 6: maximum hitting speed, Eq. 9"), name)


def test_fig2_claims_of_the_remarks(row):
    order = row("fig2", "joints by their greatest flux")
    for name in ("iiwa14_bullet", "iiwa14"):
        assert getattr(order, name).replace("5 > ", "").startswith("6 > 7")
    assert order.iiwa14_phantom.startswith("7 > 6")
    inertia = row("fig2", "joint 7: directional inertia")
    assert inertia.iiwa14_phantom > 2 * inertia.iiwa14
    swing = row("fig2", "joint 6: change of its inertia")
    assert swing.iiwa14_phantom / swing.iiwa14 == pytest.approx(9, abs=0.5)


def test_the_phantom_is_a_body_on_link_7(arm):
    """Pinocchio adding the body gives the same inertia as the parser lumping it in."""
    phantom, clean = phantom_robot(), arm("iiwa14")
    model = pin.Model(clean.model)
    flange = pin.SE3(np.eye(3), np.array(clean.flange.offset))
    model.appendBodyToJoint(7, pin.Inertia(1e-6, np.zeros(3), np.eye(3)), flange)
    for q in np.random.default_rng(0).uniform(clean.lower, clean.upper, (5, 7)):
        ours = pin.crba(phantom.model, phantom.model.createData(), q)
        np.testing.assert_allclose(ours, pin.crba(model, model.createData(), q), atol=1e-12)


@pytest.mark.parametrize("joint", [5, 6, 7])
def test_starts_are_at_one_place_and_no_posture_is_better(reproduction, joint):
    on = reproduction.experiments["iiwa14_bullet"]
    robot, start = on.robot, on.hits.starts[joint]
    np.testing.assert_allclose(
        model_position(robot, start.posture.q, joint), [0.5, 0.0, 0.5], atol=1e-8
    )
    beyond = robot.flange if joint == 7 else joint + 1
    gap = hj.position(robot, start.posture.q, beyond) - hj.position(robot, start.posture.q, joint)
    assert H @ gap < 0
    rng = np.random.default_rng(joint)
    others = np.tile(start.posture.q, (2000, 1))
    others[:, joint - 1 :] = rng.uniform(robot.lower, robot.upper, (2000, 7))[:, joint - 1 :]
    ahead = [H @ (hj.position(robot, q, beyond) - hj.position(robot, q, joint)) < 0 for q in others]
    inertia = hj.directional_inertia(robot, others[ahead], joint, H)
    assert inertia.max() <= start.posture.inertia * (1 + 1e-9)


def test_fig4_from_the_motions(reproduction, row):
    for name in VARIANTS:
        hits = reproduction.experiments[name].references
        for k in (7, 6):
            rms = {}
            for reference, words in (("constant", "constant reference"), ("optimised", "Eq. 13")):
                rows = hits[k, reference].dataset.where(lambda d: d.approach == 1, drop=True)
                error = rows.inertia - rows.desired_inertia
                rms[reference] = float((error**2).mean() ** 0.5)
                (found,) = (
                    r for r in reproduction.rows
                    if r.quantity.startswith(f"joint {k}, ") and "RMS" in r.quantity
                    and words in r.quantity
                )  # fmt: skip
                assert getattr(found, name) == pytest.approx(rms[reference])
            assert rms["optimised"] < rms["constant"] / 10
            assert hits[k, "constant"].parameters["law"] == "paper"
    assert row("fig4", "least entry of W").iiwa14_bullet < 0


def test_flux_is_short_by_what_the_field_as_printed_slows_down(reproduction, row):
    """exp(-e / sigma), sigma = 1 cm, at the lateral error e of the impact."""
    for k in (6, 7):
        hit = reproduction.experiments["iiwa14_bullet"].hits.shown(k)
        found = row("fig6", f"joint {k}: flux at the impact").iiwa14_bullet
        assert found == pytest.approx(0.3 * math.exp(-hit.impact.miss / 0.01), rel=2e-3)


def test_joint_5_cannot_have_the_flux(reproduction, row):
    on = reproduction.experiments["iiwa14_bullet"]
    assert on.hits.printed[5].reason.startswith("stalled")
    q = on.hits.qp[5].impact.q
    most = hj.hitting_flux(
        dense_inertia(on.robot, q, 5), 2.0, hj.hitting_speed(on.robot, q, 5, H, straight=True)
    )
    assert row("fig6", "joint 5: flux").iiwa14_bullet == pytest.approx(most, rel=0.01)
    assert most < 0.3 / 3


@pytest.mark.parametrize("joint", [4, 5])
def test_section_5_by_singular_values(arm, row, joint):
    robot = arm("iiwa14")
    rng = np.random.default_rng(1)
    many = rng.uniform(robot.lower, robot.upper, (50, 7))
    ranks = {np.linalg.matrix_rank(difference_jacobian(robot, q, joint), tol=1e-6) for q in many}
    assert ranks == {row("text", f"joint {joint}: rank").iiwa14}
    radii = [
        np.linalg.norm(model_position(robot, q, joint) - model_position(robot, q, 2)) for q in many
    ]
    if joint == 4:
        np.testing.assert_allclose(radii, 0.2045 + 0.2155, atol=1e-9)
        assert row("text", "joint 4: distance").iiwa14 == pytest.approx(0.42)
        upright = np.array([0.3, 0, 0.2, 1, 0, 0, 0])
        assert np.linalg.matrix_rank(difference_jacobian(robot, upright, 4), tol=1e-6) == 1
    else:
        assert np.ptp(radii) > 0.1
        straight = np.array([0.3, 0.5, 0.2, 0, 0, 0, 0])
        assert np.linalg.matrix_rank(difference_jacobian(robot, straight, 5), tol=1e-6) == 2


def test_joint_5_moves_away_from_joint_2_by_its_elbow_alone(arm, row):
    """The distance depends on q_4 only: its rate is |d distance / d q_4| times the limit."""
    robot = arm("iiwa14")
    q = hj.place_joint(robot, 5, OBJECT, start=robot.home).q[0]
    step = 1e-6 * np.eye(7)[3]
    far, near = (
        np.linalg.norm(model_position(robot, x, 5) - model_position(robot, x, 2))
        for x in (q + step, q - step)
    )
    rate = abs(far - near) / 2e-6 * robot.velocity_upper[3]
    found = row("text", "joint 5: greatest speed away")
    assert found.iiwa14 == pytest.approx(rate, rel=1e-6)


def test_many_postures_are_those_of_the_planner(arm):
    """The grid comes within half a per cent of the global optimum, and never above it."""
    robot = arm("iiwa14_bullet")
    for joint in (6, 7):
        placed = hj.place_joint(robot, joint, np.tile([0.5, 0.0, 0.5], (24, 1)), seed=3)
        q, inertia = best_postures(robot, placed.q, joint, H)
        checked = 0
        for given, found, best in zip(placed.q, inertia, q, strict=True):
            try:
                optimum = hj.posture(robot, given, joint, H, certificate=False).inertia
            except hj.InfeasibleError:
                assert math.isnan(found)
                continue
            assert 0.995 * optimum <= found <= optimum * (1 + 1e-9)
            assert found == pytest.approx(dense_inertia(robot, best, joint), rel=1e-7)
            checked += 1
        assert checked >= 5


def test_many_motions_are_rollouts_without_the_null_space(reproduction):
    on = reproduction.experiments["iiwa14_bullet"]
    for k in (6, 7):
        q0 = on.hits.starts[k].posture.q
        hit = hj.Hit(k, OBJECT, H, 2.0, 0.3)
        rolled = hj.rollout(on.robot, hit, q0=q0, law="paper", gains=Gains(0, 0)).impact
        q, arrived = along_the_line(on.robot, q0[None], k, H, 0.3)
        assert arrived.all()
        found = dense_inertia(on.robot, q[0], k)
        assert found == pytest.approx(rolled.inertia, rel=5e-3)


def test_motions_beyond_a_limit_do_not_count(arm):
    robot = arm("iiwa14_bullet")
    q = hj.place_joint(robot, 7, [0.5, 0.0, 0.5], start=robot.home).q
    _, arrived = along_the_line(robot, q, 7, H, 1.5)  # beyond the reach
    assert not arrived.any()
    placed = hj.place_joint(robot, 6, np.tile([0.5, 0.0, 0.5], (200, 1)), seed=2).q
    q, arrived = along_the_line(robot, placed, 6, H, 0.3)
    at_object = [np.linalg.norm(model_position(robot, x, 6) - OBJECT) < 1e-3 for x in q]
    within = ((q >= robot.lower) & (q <= robot.upper)).all(axis=1)
    assert (np.array(at_object) & ~within).any()  # some get there beyond their limits
    assert (within | ~arrived).all()
    assert arrived.any()


@pytest.mark.parametrize("name", VARIANTS)
def test_percentiles_by_counting(reproduction, row, name):
    spread = reproduction.experiments[name].spread
    assert getattr(row("spread", "random setups in which"), name) == len(spread.start) > 50
    for k, printed in ((7, 2.5), (6, 3.9)):
        below = 100 * sum(value < printed for value in spread.inertia[k]) / len(spread.start)
        found = row("spread", f"joint {k}: setups with less than the printed")
        assert getattr(found, name) == pytest.approx(below)
        median = sorted(spread.inertia[k])[len(spread.start) // 2]
        shown_median = row("spread", f"joint {k}: inertia at the impact, median")
        assert getattr(shown_median, name) == pytest.approx(median, rel=0.02)


def test_the_printed_kilograms_speak_against_the_phantom(row):
    near = row("spread", "both kilograms are within 10 %")
    assert near.iiwa14_bullet > 1
    assert near.iiwa14_phantom == 0
    assert row("spread", "joint 7: setups with less").iiwa14_phantom == 0


def test_joint_7_is_heavy_where_its_last_link_lies_along_the_direction(reproduction, row):
    on = reproduction.experiments["iiwa14_bullet"]
    q = on.hits.shown(7).impact.q
    link = model_position(on.robot, q, 7) - model_position(on.robot, q, 6)
    cosine = abs(link[1]) / 0.081  # the URDF's distance of joint 7 from joint 6
    found = row("fig6", "angle of its last link").iiwa14_bullet
    assert math.cos(math.radians(found)) == pytest.approx(cosine, abs=1e-9)
    angle, inertia = on.spread.angle, on.spread.inertia[7]
    assert ((angle >= 0) & (angle <= 90)).all()
    across, along = inertia[angle > 75], inertia[(angle > 30) & (angle < 45)]
    assert np.median(along) > 1.3 * np.median(across)
    near = angle[np.abs(inertia - 2.5) <= 0.25]
    shown_near = row("spread", "the same, of setups within 10 %").iiwa14_bullet
    assert shown_near == pytest.approx(np.median(near))
    assert shown_near < found - 15


def test_the_spread_is_the_same_every_time(arm):
    scenario = Scenario(setups=500)
    first, second = (study_spread(arm("iiwa14"), scenario) for _ in range(2))
    for k in (6, 7):
        np.testing.assert_array_equal(first.inertia[k], second.inertia[k])


def test_figures_are_drawn(reproduction, tmp_path):
    from matplotlib.image import imread

    figures = draw_reproduction(reproduction, Look())
    assert list(figures) == ["fig2", "fig4", "fig5", "fig6", "spread"]
    for name, figure in figures.items():
        save_figure(figure, tmp_path / f"{name}.png")
        pixels = imread(tmp_path / f"{name}.png")[::4, ::4, :3].reshape(-1, 3)
        assert len({tuple(pixel) for pixel in pixels}) > 50
        assert 0.005 < (pixels.mean(axis=1) < 0.9).mean() < 0.5


def test_table_keeps_every_row(reproduction):
    read = list(csv.DictReader(as_csv(reproduction.rows).splitlines()))
    assert [r["quantity"] for r in read] == [r.quantity for r in reproduction.rows]
    at = next(i for i, r in enumerate(read) if r["paper"] == "3.9")
    assert float(read[at]["iiwa14"]) == reproduction.rows[at].iiwa14
    lines = as_markdown(reproduction.rows).splitlines()
    assert len(lines) == 2 + len(read)
    assert {line.replace("\\|", "").count("|") for line in lines} == {8}


def test_the_table_in_the_docs_is_not_stale(reproduction):
    text = (Path(__file__).parents[2] / "docs/reproduction_table.md").read_text()
    lines = [re.split(r"(?<!\\) \| ", line[2:-2]) for line in text.splitlines()[2:]]
    assert [line[1] for line in lines] == [
        r.quantity.replace("|", "\\|") for r in reproduction.rows
    ]
    for line, r in zip(lines, reproduction.rows, strict=True):
        if r.figure == "spread":
            continue  # of more setups
        for cell, value in zip(line[2:6], list(r.as_dict().values())[2:6], strict=True):
            if isinstance(value, float):
                assert float(cell) == pytest.approx(value, rel=6e-3, abs=1e-6), r
            else:
                assert cell == shown(value)


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (3.9, "3.90"), (118.76, "119"), (0.0022, "0.00220"), (3e-16, "0"), (7, "7"),
     (-0.334, "-0.334"), ("6 > 7", "6 > 7")],
)  # fmt: skip
def test_numbers_have_three_digits(value, text):
    assert shown(value) == text


def test_command(run, tmp_path):
    folder = tmp_path / "new" / "folder"
    outcome = run("reproduce", "fig2", "--out", folder, "--json")
    assert outcome.code == 0
    made = sorted(path.name for path in folder.iterdir())
    assert made == ["fig2.pdf", "fig2.png", "table.csv", "table.md"]
    assert (folder / "fig2.pdf").read_bytes().startswith(b"%PDF")
    rows = outcome.json["rows"]
    assert all(set(r) == set(ClaimRow.__dataclass_fields__) for r in rows)
    assert {r["figure"] for r in rows} == {"fig2"}
    assert outcome.json["scenario"]["mass"] == 2
    shown_again = run("reproduce", "fig2", "--out", folder)
    assert "relatively strong" in shown_again.words


@pytest.mark.parametrize("name", ["fig3", "FIG2", "2"])
def test_no_such_figure_is_wrong_usage(run, tmp_path, name):
    outcome = run("reproduce", name, "--out", tmp_path / "x")
    assert (outcome.code, outcome.out) == (2, "")
    assert "fig2, fig4, fig6, all" in outcome.err
    assert not (tmp_path / "x").exists()


def test_a_folder_that_cannot_be_made(run, tmp_path):
    (tmp_path / "file").write_text("")
    for out in (tmp_path / "file", tmp_path / "file" / "below"):
        outcome = run("reproduce", "--out", out, "--json")
        assert (outcome.code, outcome.out) == (1, "")
        assert outcome.err.count("\n") == 1
        assert outcome.err.startswith("error: out = ")


def test_python_refuses_what_it_cannot_do():
    with pytest.raises(hj.InputError, match="figure = 'fig9'"):
        hj.reproduce("fig9")
    for setups in (10, 1.5, "many"):
        with pytest.raises(hj.InputError, match="setups"):
            hj.reproduce("fig6", setups=setups)
