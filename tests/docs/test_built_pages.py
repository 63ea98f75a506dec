"""The pages as built: nothing is fetched from a network, every command and name has its place."""

import re
import subprocess
import sys

import command_reference
import pytest
from markdown_pages import ROOT

FETCHED = re.compile(
    r'<(?:script|link|img|iframe|source)\b[^>]*?(?:src|href)="((?:https?:)?//[^"]*)"'
)


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Return the pages by name, built as `make docs` does."""
    folder = tmp_path_factory.mktemp("html")
    build = [sys.executable, "-m", "sphinx", "-W", "-q", "-b", "html", ROOT / "docs", folder]
    run = subprocess.run(build, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    found = {path.stem: path.read_text() for path in folder.glob("*.html")}
    styles = "".join(path.read_text() for path in (folder / "_static").glob("**/*.css"))
    return found | {"styles": styles}


def test_no_page_fetches_anything_from_a_network(built):
    for name, text in built.items():
        assert FETCHED.findall(text) == [], name
    assert re.findall(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//", built["styles"]) == []


def test_formulas_are_mathml(built):
    theory = built["theory"]
    assert theory.count("<math") >= 50
    assert "\\frac" not in re.sub(r"<annotation.*?</annotation>", "", theory)


def test_every_command_and_option_is_in_the_reference(built):
    text = re.sub(r"<[^>]+>", "", built["commands"])
    for name, command in command_reference.commands().items():
        usage = command_reference.described(name, command).usage
        assert text.count(usage) == 1
        section = text.split(usage)[1]
        for parameter in command.params:
            for option in (*parameter.opts, *parameter.secondary_opts):
                if option.startswith("--"):
                    assert option in section, (name, option)


def test_a_default_is_told_once():
    for name, command in command_reference.commands().items():
        told = command_reference.described(name, command)
        for options in told.panels.values():
            for typed, meaning in options:
                assert meaning.count("default") <= 1, (name, typed, meaning)


def test_every_page_is_in_the_contents(built):
    contents = built["index"]
    for page in (ROOT / "docs").glob("*.md"):
        if page.stem not in ("index", *INCLUDED):
            assert f'href="{page.stem}.html"' in contents, page.stem


INCLUDED = ("benchmarks_table", "reproduction_table")
"""Parts of other pages."""
