"""What can be wrong with a recording: said per file, and the rest goes on."""

import json
import re
import shutil

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import hitjoints as hj
from tests.oracles.synthetic_recordings import HEADER, OBJECT_HEADER, Truth, write_recording

NAMES, OBJECT_NAMES = HEADER.split(","), OBJECT_HEADER.split(",")


@pytest.fixture(scope="module")
def clean(tmp_path_factory):
    """Return the texts of a robot's and an object's file."""
    folder = tmp_path_factory.mktemp("clean")
    written = write_recording(folder, 1, Truth(duration=1.2))
    return written.file.read_text(), written.object_file.read_text()


@pytest.fixture
def folder(tmp_path, clean):
    """Return a folder with hit 1, to be spoilt, and hit 2, which stays."""
    for number in (1, 2):
        (tmp_path / f"IIWA_14_hit_{number}.csv").write_text(clean[0])
        (tmp_path / f"object_1_hit_{number}.csv").write_text(clean[1])
    return tmp_path


def edit(text, line, column, change, names=NAMES):
    """Return the text with one field changed; lines count from 1, as in an editor."""
    lines = text.split("\n")
    fields = lines[line - 1].split(",")
    at = names.index(column)
    fields[at] = change(fields[at])
    lines[line - 1] = ",".join(fields)
    return "\n".join(lines)


def without(text, column, names, start):
    lines = text.strip("\n").split("\n")
    at = names.index(column)
    kept = [
        ",".join(field for i, field in enumerate(line.split(",")) if i != at)
        for line in lines[start:]
    ]
    return "\n".join([*lines[:start], *kept]) + "\n"


def cut(text, first, last):
    lines = text.split("\n")
    return "\n".join(lines[:first] + lines[last:])


def first_to_nan(field):
    return " ".join(["nan", *field.split()[1:]])


# name: (what is done to the robot's file, words of the reason). None of these can be used.
USELESS = {
    "no positions": (lambda t: without(t, "JointPosition", NAMES, 1), "no column JointPosition"),
    "no velocities": (lambda t: without(t, "JointVelocity", NAMES, 1), "no column JointVelocity"),
    "no time": (lambda t: without(t, "RosTime", NAMES, 1), "no column RosTime"),
    "nan": (
        lambda t: edit(t, 57, "JointPosition", first_to_nan),
        "line 57, column JointPosition: nan",
    ),
    "infinite": (
        lambda t: edit(t, 9, "RosTime", lambda f: "1e999"),
        "line 9, column RosTime: 1e999",
    ),
    "no number": (lambda t: edit(t, 9, "RosTime", lambda f: "noon"), "'noon' is no number"),
    "six joints in a row": (
        lambda t: edit(t, 9, "JointPosition", lambda f: " ".join(f.split()[:6])),
        "line 9, column JointPosition: 6 numbers, 7 expected",
    ),
    "a short row": (
        lambda t: re.sub(r"(?m)^((?:.*\n){30})(IIWA_14,[^,]*),.*$", r"\1\2", t, count=1),
        "line 31 has 2 fields",
    ),
    "too large to be true": (
        lambda t: edit(t, 9, "JointVelocity", lambda f: "1e300 " * 7),
        "line 9, column JointVelocity: 1e300",
    ),
    "time goes back": (
        lambda t: edit(t, 20, "RosTime", lambda f: repr(float(f) - 1)),
        "RosTime goes back at row 18",
    ),
    "another robot": (lambda t: t.replace("IIWA_14", "IIWA_7"), "it fits iiwa14"),
    "a gap at the contact": (lambda t: cut(t, 110, 140), "robot_speed: a gap of 0.155 s"),
    "empty": (lambda t: "", "it is empty"),
    "only a header": (lambda t: "\n".join(t.split("\n")[:2]), "no rows"),
    "garbage": (lambda t: "\x00\x01 not a table", "no recording"),
}
# None of these keeps the robot's quantities from being found.
PARTLY = {
    "no flux": (lambda t: without(t, "HittingFlux", NAMES, 1), "no column HittingFlux"),
    "no inertia": (lambda t: without(t, "Inertia", NAMES, 1), "no column Inertia"),
    "no tool": (lambda t: without(t, "EEF_Position", NAMES, 1), "no column EEF_Position"),
    "nan in the inertia": (
        lambda t: edit(t, 40, "Inertia", first_to_nan),
        "line 40, column Inertia: nan",
    ),
    "the last row is cut": (lambda t: t[: t.rindex(",") - 90], "the last, is cut short: left out"),
    "a gap elsewhere": (lambda t: cut(t, 20, 40), "gaps in RosTime: 0.105 s after 0.085 s"),
    "a velocity that is not that of the joints": (
        lambda t: edit(t, 30, "JointVelocity", lambda f: "0.5 " * 7),
        "velocity_error: the velocity is 0.",
    ),
    "a flux that is another's": (
        lambda t: edit(t, 30, "HittingFlux", lambda f: "0.5"),
        "recorded_flux_error: HittingFlux is 0.",
    ),
    "a mark at the start": (lambda t: "\ufeff" + t, ""),
    "unused columns that are empty": (lambda t: edit(t, 9, "TorqueCmd", lambda f: ""), ""),
}
# What is done to the object's file; the robot's is whole.
OBJECT = {
    "no position": (
        lambda t: t.replace("PositionFor", "Unused"),
        "no column PositionForIiwa7",
    ),
    "nan": (
        lambda t: edit(t, 30, "PositionForIiwa7", first_to_nan, OBJECT_NAMES).replace(
            "PositionForIiwa14", "Unused"
        ),
        "line 30, column PositionForIiwa7: nan",
    ),
    "empty": (lambda t: "", "object_1_hit_1.csv: it is empty"),
    "a gap at the contact": (lambda t: cut(t, 115, 130), "the contact lies in a gap"),
    "ends with the contact": (lambda t: cut(t, 130, 999), "object_speed: "),
}  # fmt: skip


def both(folder, **options):
    one, other = hj.replay(folder, **options).hits
    assert other.ok
    assert other.restitution is not None
    return one


@pytest.mark.parametrize("name", USELESS)
def test_useless(folder, clean, name):
    change, words = USELESS[name]
    changed = change(clean[0])
    assert changed != clean[0]
    (folder / "IIWA_14_hit_1.csv").write_text(changed)
    hit = both(folder)
    assert not hit.ok
    assert words in hit.reason
    assert "\n" not in hit.reason
    assert hit.flux is hit.object_speed is None


@pytest.mark.parametrize("name", PARTLY)
def test_partly(folder, clean, name):
    change, words = PARTLY[name]
    changed = change(clean[0])
    assert changed != clean[0]
    (folder / "IIWA_14_hit_1.csv").write_text(changed)
    hit = both(folder)
    assert hit.ok
    assert words in hit.reason
    assert hit.flux == pytest.approx(hj.replay(folder).hits[1].flux, rel=1e-6)
    assert hit.restitution is not None
    if name == "no tool":
        assert hit.lag is hit.position_error is None
    if name in {"no flux", "no inertia", "nan in the inertia"}:
        assert hit.recorded_flux_error is None
        assert (hit.mass, hit.mass_source) == (0.4, "default")


@pytest.mark.parametrize("name", OBJECT)
def test_object(folder, clean, name):
    change, words = OBJECT[name]
    changed = change(clean[1])
    assert changed != clean[1]
    (folder / "object_1_hit_1.csv").write_text(changed)
    hit = both(folder)
    assert hit.ok
    assert hit.flux is not None
    assert words in hit.reason
    if name == "a gap at the contact":
        assert hit.contact_source == "robot"
    else:
        assert hit.restitution is hit.object_speed is None


def test_not_hit_at_all(folder, clean):
    still = clean[1].split("\n")
    row = still[1].split(",", 1)[1]
    lines = [still[0], *(f"{line.split(',', 1)[0]},{row}" for line in still[1:-1])]
    (folder / "object_1_hit_1.csv").write_text("\n".join(lines))
    hit = both(folder)
    assert not hit.ok
    assert "no contact: the object moves by 0 mm at most" in hit.reason


def test_not_text(folder):
    (folder / "IIWA_14_hit_1.csv").write_bytes(b"\xff\xfe\x00R\x00o")
    assert "byte 0 is not UTF-8" in both(folder).reason


def test_a_given_robot_that_does_not_fit(folder):
    for hit in hj.replay(folder, robot="iiwa7").hits:
        assert not hit.ok
        assert "not a recording of iiwa7" in hit.reason
        assert "fits iiwa14" in hit.reason


def test_another_tool(folder):
    for hit in hj.replay(folder, offset=(0, 0, 0.2)).hits:
        assert re.search(r"the tool is 0\.0[45]\d* m off; no built-in robot fits", hit.reason)


@pytest.mark.parametrize(
    ("option", "words"),
    [
        ({"mass": -1.0}, "mass = -1"),
        ({"mass": float("nan")}, "mass = nan"),
        ({"restitution": 1.2}, "restitution = 1.2"),
        ({"direction": [0, 0, 0]}, "direction"),
        ({"direction": [[0, 1, 0]]}, "direction"),
        ({"offset": (0, 0)}, "offset"),
        ({"robot": "iiwa15"}, "robot = 'iiwa15'"),
    ],
)
def test_arguments(folder, option, words):
    with pytest.raises(hj.InputError, match=re.escape(words)):
        hj.replay(folder, **option)


@pytest.fixture(scope="module")
def scratch(tmp_path_factory, clean):
    folder = tmp_path_factory.mktemp("scratch")
    (folder / "object_1_hit_1.csv").write_text(clean[1])
    return folder


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(data=st.data())
def test_any_corruption_ends_in_a_reason(scratch, clean, data):
    """Whatever is cut, doubled or overwritten: one hit, no NaN, and a reason if it is not ok."""
    text = clean[0]
    for _ in range(data.draw(st.integers(1, 3))):
        start = data.draw(st.integers(0, len(text)))
        stop = min(len(text), start + data.draw(st.integers(0, 3000)))
        more = data.draw(
            st.one_of(
                st.text(alphabet="0123456789.,-e \nnaif", max_size=30),
                st.sampled_from(["1e308", "-1e300", "0", ",,,", "\n\n", text[start:stop] * 2]),
            )
        )
        text = text[:start] + more + text[stop:]
    (scratch / "IIWA_14_hit_1.csv").write_text(text)
    (hit,) = hj.replay(scratch).hits
    assert hit.ok or hit.reason
    json.dumps(hit.as_dict(), allow_nan=False)


def test_a_folder_that_shrinks_meanwhile(folder):
    shutil.copy(folder / "IIWA_14_hit_1.csv", folder / "IIWA_14_hit_3.csv")

    def remove(done, total):
        (folder / "IIWA_14_hit_3.csv").unlink(missing_ok=True)

    hits = hj.replay(folder, progress=remove).hits
    assert [hit.ok for hit in hits] == [True, True, False]
    assert "cannot be read (No such file" in hits[2].reason
