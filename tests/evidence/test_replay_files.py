"""Which files are taken, and which object belongs to which robot."""

import pytest

from hitjoints.evidence.recordings.hit_files import find


@pytest.fixture
def tree(tmp_path):
    """Return a folder with the files named, all empty."""

    def make(*names):
        for name in names:
            path = tmp_path / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
        return tmp_path

    return make


def names(found):
    return [(one.file.name, one.object_file and one.object_file.name) for one in found]


def test_a_folder_with_folders(tree):
    root = tree(
        "a/IIWA_7_hit_10.csv", "a/IIWA_7_hit_2.csv", "a/object_1_hit_2.csv",
        "b/c/IIWA_14_hit_1.csv", "b/c/object_2_hit_1.csv", "b/notes.csv", "b/readme.txt",
    )  # fmt: skip
    assert names(find([root])) == [
        ("IIWA_7_hit_2.csv", "object_1_hit_2.csv"),
        ("IIWA_7_hit_10.csv", None),
        ("IIWA_14_hit_1.csv", "object_2_hit_1.csv"),
    ]


def test_files_each_once(tree, monkeypatch):
    root = tree("IIWA_7_hit_1.csv", "object_1_hit_1.csv")
    monkeypatch.chdir(root)
    found = find([root / "IIWA_7_hit_1.csv", root, type(root)("IIWA_7_hit_1.csv")])
    assert names(found) == [("IIWA_7_hit_1.csv", "object_1_hit_1.csv")]


def test_a_pattern_names_the_objects_files_too(tree):
    root = tree("IIWA_7_hit_1.csv", "object_1_hit_1.csv", "object_1_hit_2.csv")
    found = find(sorted(root.iterdir()))
    assert names(found) == [
        ("IIWA_7_hit_1.csv", "object_1_hit_1.csv"),
        ("object_1_hit_2.csv", None),
    ]
    assert found[0].problem == ""
    assert "name the robot's" in found[1].problem


def test_two_objects_are_none(tree):
    (found,) = find([tree("IIWA_7_hit_1.csv", "object_1_hit_1.csv", "object_2_hit_1.csv")])
    assert found.object_file is None
    assert "object_1_hit_1.csv, object_2_hit_1.csv" in found.no_object


def test_another_number_is_another_hit(tree):
    (found,) = find([tree("IIWA_7_hit_1.csv", "object_1_hit_11.csv")])
    assert found.no_object == "no file object_*_hit_1.csv beside it"


def test_a_number_may_be_a_name(tree):
    root = tree("IIWA_7_hit_b.csv", "object_1_hit_B.csv", "IIWA_7_hit_07.csv", "object_1_hit_7.csv")
    assert names(find([root])) == [
        ("IIWA_7_hit_b.csv", "object_1_hit_B.csv"),
        ("IIWA_7_hit_07.csv", "object_1_hit_7.csv"),
    ]


def test_any_name_when_it_is_named(tree):
    (found,) = find([tree("mine.csv") / "mine.csv"])
    assert found.problem == ""
    assert "does not end in _hit_N.csv" in found.no_object


def test_nothing_there(tree):
    root = tree("empty/readme.txt")
    problems = [one.problem for one in find([root / "no.csv", root / "empty"])]
    assert problems[0] == "there is no such file"
    assert "no robot's file" in problems[1]
