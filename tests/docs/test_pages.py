"""What the pages show is true: their code runs, their commands answer what is printed there."""

import importlib.util
import re
import tomllib

import pytest
from command_reference import commands
from markdown_pages import KINDS, ROOT, blocks, command_lines, pages, says, spans

from hitjoints.cli.app import app

PAGES = pages()
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
TARGETS = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.M)
by_name = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)


@by_name
@pytest.mark.filterwarnings("ignore::hitjoints.loading.load.ModelWarning")
def test_everything_on_a_page_runs(page, tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.setenv("COLUMNS", "80")
    namespace = {"__name__": page.stem}
    runnable = [b for b in blocks(page) if not (b.directive or "not run" in b.notes)]
    for block in runnable:
        if block.file:
            (tmp_path / block.file).write_text(block.text + "\n")
    for block in runnable:
        where = f"{page.name}:{block.line}"
        if block.kind == "python":
            exec(compile("\n" * block.line + block.text, page, "exec"), namespace)
        elif block.kind == "toml":
            tomllib.loads(block.text)
        elif block.kind == "console":
            for line in command_lines(block.text):
                try_line(line, int(block.notes.get("exit code", 0)), run, where)


def try_line(line, code, run, where):
    """Run a command of ours; of others see that they are there."""
    program, *arguments = line.words
    if program == "hitjoints":
        answer = run(*arguments)
        assert answer.code == code, f"{where}: {line.words} ended with {answer.code}: {answer.err}"
        for said in line.said:
            assert says(answer.out + answer.err, said), f"{where}: not printed: {said}"
    elif program == "make":
        assert set(arguments) <= set(TARGETS), where
    elif program == "pip":
        extras = re.findall(r"\[([\w,]+)\]", " ".join(arguments))
        asked = {extra for some in extras for extra in some.split(",")}
        assert asked <= set(PROJECT["optional-dependencies"]), where
    elif "-m" in arguments:
        assert importlib.util.find_spec(arguments[arguments.index("-m") + 1]), where
    else:
        files = [word for word in arguments if word.endswith((".py", ".ipynb"))]
        assert files, f"{where}: nobody knows whether {line.words} runs: say why it is not run"
        assert all((ROOT / file).is_file() for file in files), where


def options_of(command):
    """Return the names of a command's options."""
    return {name for p in command.params for name in (*p.opts, *p.secondary_opts)}


@by_name
def test_commands_within_sentences_have_the_options_they_are_given(page):
    import typer

    for words in spans(page):
        command, rest = typer.main.get_command(app), words[1:]
        while rest and rest[0] in getattr(command, "commands", {}):
            command, rest = command.commands[rest[0]], rest[1:]
        asked = {word.split("=")[0] for word in rest if word.startswith("--")}
        assert asked <= options_of(command) | {"--help"}, words
        groups = getattr(command, "commands", {})
        assert not (groups and rest and rest[0].isalpha()), f"no such command: {words}"


@by_name
def test_options_that_a_page_speaks_of_exist(page):
    spoken = set(re.findall(r"`(--[a-z][\w-]+)", page.read_text()))
    known = {option for command in commands().values() for option in options_of(command)}
    scripts = "".join(script.read_text() for script in (ROOT / "benchmarks").glob("*.py"))
    known |= {"--help", *re.findall(r'add_argument\(\s*"(--[\w-]+)"', scripts)}
    assert spoken <= known


@by_name
def test_a_block_says_what_it_is(page):
    for block in blocks(page):
        assert block.directive or block.kind in KINDS, f"{page.name}:{block.line}: {block.kind!r}"


def test_what_make_demo_types_and_tells_to_type_runs(tmp_path, monkeypatch, run):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "out").mkdir()
    recipe = (ROOT / "Makefile").read_text().split("\ndemo:")[1].split("\n\n")[0]
    typed = re.findall(r"\$\(BIN\)/hitjoints (.*?)(?: {2,}.*)?$", recipe, re.M)
    assert len(typed) == 5
    for words in typed:
        if "path/to" not in words:
            assert run(*words.split()).code == 0, words
    assert len(list(tmp_path.glob("out/*.png"))) == 3


def test_few_blocks_are_not_run():
    found = [block for page in PAGES for block in blocks(page) if not block.directive]
    shown = [block for block in found if block.kind in ("python", "console")]
    left = [block for block in shown if "not run" in block.notes]
    assert len(shown) >= 40
    assert len(left) <= 6, [(block.line, block.notes) for block in left]


def test_a_line_that_is_not_printed_is_found():
    printed = "  inertia  |  8.312  kg\n joint 6: best"
    assert says(printed, "inertia   8.31 kg")
    assert says(printed, "joint 6: best")
    assert not says(printed, "inertia 9.31 kg")
    assert not says(printed, "joint 7: best")
    assert not says(printed, "speed")
