"""The page on the file of a hit knows every key of the file and of the answer."""

import re
from pathlib import Path

import pytest

import hitjoints as hj
from hitjoints.hit_file import HitTables

PAGE = Path(__file__).parent.parent / "docs" / "hit_file.md"


@pytest.fixture(scope="module")
def sections():
    """Return the names that each section of the page explains."""
    parts = PAGE.read_text(encoding="utf-8").split("\n## ")
    return {part.split("\n")[0]: set(re.findall(r"`([a-z_0-9]+)`", part)) for part in parts}


def test_every_key_of_the_file_is_explained(sections):
    text = PAGE.read_text(encoding="utf-8")
    known = sections["hit.toml"]
    for name, field in HitTables.model_fields.items():
        if name == "schema_":
            continue
        assert f"`[{name}]`" in text
        assert set(field.annotation.model_fields) <= known, name
    assert "schema" in known


def test_every_key_of_the_answer_is_explained(sections, arm):
    hit = hj.Hit(
        7, (0.5, 0.2, 0.4), mass=1.0, goal=(0.5, 3.0, 0.4), friction=0.3, restitution=0.4
    )  # fmt: skip
    no = hj.answer(hit, arm("iiwa14"))
    yes = hj.answer(hit.changed(goal=(0.5, 0.25, 0.4)), arm("iiwa14"))
    known = sections["The answer"]
    for told in (no.as_dict(), yes.as_dict()):
        assert set(told) <= known
        for part in ("nearest", "landing", "simulated"):
            assert set(told[part] or ()) <= known, part
    assert no.as_dict()["nearest"] is not None
    assert yes.as_dict()["simulated"] is not None
