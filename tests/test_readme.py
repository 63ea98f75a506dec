"""The README begins with what sets everything up, and its tables tell the truth."""

import inspect
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


def arguments_of(thing):
    """Return the names of what a public function or class is called with."""
    called = thing.__init__ if inspect.isclass(thing) else thing
    some = (inspect.Parameter.VAR_POSITIONAL, inspect.Parameter.VAR_KEYWORD)
    taken = [p for p in inspect.signature(called).parameters.values() if p.kind not in some]
    return {p.name for p in taken} - {"self"}


def test_every_argument_of_a_public_name_is_in_its_docstring():
    for name in hj.__all__:
        thing = getattr(hj, name)
        if not callable(thing) or (inspect.isclass(thing) and issubclass(thing, Exception)):
            continue
        told = set(re.findall(r"^ +\**(\w+): ", thing.__doc__, re.M))
        missing = {word for word in arguments_of(thing) - told if not word.startswith("_")}
        assert not missing, (name, missing)


def test_links_of_the_readme_lead_somewhere():
    links = re.findall(r"\]\((?!http)([^)#]+)", README)
    assert len(links) > 10
    assert [link for link in links if not (ROOT / link).exists()] == []


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
