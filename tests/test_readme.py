"""The README begins with what sets everything up, and its tables tell the truth."""

import re
from pathlib import Path

import hitjoints as hj

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text()
STUB = (ROOT / "hitjoints" / "__init__.pyi").read_text()


def test_the_section_on_robots_names_every_robot_once():
    section = README.split("## Robots")[1].split("##")[0]
    named = re.findall(r"^\| `(\w+)`", section, re.M)
    named += re.findall(r"`(\w+)`", section.split("Also by name")[1].split("Any other arm")[0])
    assert sorted(named) == sorted(hj.robot_names())


def test_what_sets_everything_up_comes_first():
    first = README.split("```")[1].removeprefix("console")
    typed = [line.removeprefix("$ ").split("#")[0].strip() for line in first.strip().splitlines()]
    assert typed == ["pip install .", "make demo", "make test"]


def test_every_public_name_exists_and_has_its_place_in_the_reference():
    listed = re.findall(r"^from \.[\w.]* import (.+?)$", STUB, re.M)
    assert len(listed) > 20
    assert hj.__all__ == sorted(set(hj.__all__))
    for name in hj.__all__:
        assert getattr(hj, name).__doc__ or name == "__version__", name
    pages = "".join(page.read_text() for page in (ROOT / "docs").glob("*.md"))
    documented = set(
        re.findall(
            r"auto(?:function|class|exception|module):: hitjoints\.(?:show\.)?(\w+)$", pages, re.M
        )
    )
    assert set(hj.__all__) - documented - {"__version__"} == set()
