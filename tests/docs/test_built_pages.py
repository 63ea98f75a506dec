"""The pages as built: nothing is fetched from a network, every command and name has its place."""

import re

import command_reference
import pytest
from markdown_pages import ROOT

FETCHED = re.compile(
    r'<(?:script|link|img|iframe|source)\b[^>]*?(?:src|href)="((?:https?:)?//[^"]*)"'
)


@pytest.fixture(scope="module")
def written(built):
    """Return the pages by name."""
    return {path.stem: path.read_text() for path in built.glob("*.html")}


def test_no_page_fetches_anything_from_a_network(built, written):
    for name, text in written.items():
        assert FETCHED.findall(text) == [], name
    for style in built.glob("_static/**/*.css"):
        assert re.findall(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//", style.read_text()) == []


def test_formulas_are_mathml(written):
    theory = written["theory"]
    assert theory.count("<math") >= 50
    assert "\\frac" not in re.sub(r"<annotation.*?</annotation>", "", theory)


def test_every_command_and_option_is_in_the_reference(written):
    text = re.sub(r"<[^>]+>", "", written["commands"])
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


def test_every_page_is_in_the_contents(written):
    sources = {path.stem: path.read_text() for path in (ROOT / "docs").glob("*.md")}
    parts = set(re.findall(r"^```\{include\} (\w+)\.md$", "\n".join(sources.values()), re.M))
    assert len(parts) >= 2
    for page in set(sources) - parts - {"index"}:
        assert f'href="{page}.html"' in written["index"], page
