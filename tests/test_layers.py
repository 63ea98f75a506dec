"""Data flows one way: a file imports from its own floor or one below, and never in a circle.

CONTRIBUTING.md's table of floors is the one place that says what lies above what.
"""

import ast
import re
from collections import Counter
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FILES = sorted([*ROOT.glob("hitjoints/**/*.py"), *ROOT.glob("cli/*.py")])


def floors() -> dict[str, int]:
    """Return the height of every place that CONTRIBUTING's table names, from 0 at the bottom."""
    table = (ROOT / "CONTRIBUTING.md").read_text().split("## Layers")[1].split("\n## ")[0]
    cells = [line.split("|")[1] for line in table.splitlines() if line.startswith("|")]
    rows = [names for cell in cells if (names := re.findall(r"`([\w/.]+)`", cell))]
    return {name: height for height, names in enumerate(reversed(rows)) for name in names}


def module(path: Path) -> str:
    parts = path.relative_to(ROOT).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(path: Path, known: dict[str, Path], *, for_types: bool) -> set[str]:
    """Return the modules that a file imports, function bodies included.

    Args:
        path: the file.
        known: every module of the project by its name.
        for_types: those of `if TYPE_CHECKING` as well.
    """
    tree = ast.parse(path.read_text())
    if not for_types:
        for node in ast.walk(tree):
            if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
                node.body = []
    found = set()
    package = module(path) if path.name == "__init__.py" else module(path).rpartition(".")[0]
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names = [(alias.name, "") for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                above = package.split(".")[: len(package.split(".")) - node.level + 1]
                base = ".".join([*above, *([node.module] if node.module else [])])
            names = [(base, alias.name) for alias in node.names]
        else:
            continue
        for base, name in names:
            whole = f"{base}.{name}".replace("hitjoints.cli", "cli")
            origin = base.replace("hitjoints.cli", "cli")
            found.add(whole if whole in known else origin)
    return (found & known.keys()) - {module(path)}


KNOWN = {module(path): path for path in FILES}


def height(path: Path, levels: dict[str, int]) -> int:
    """Return the floor of a file: that of the longest name in the table it lies under."""
    place = path.relative_to(ROOT).as_posix()
    fitting = [name for name in levels if place == name or place.startswith(name.rstrip("/") + "/")]
    assert fitting, f"{place} has no floor in CONTRIBUTING.md"
    return levels[max(fitting, key=len)]


def test_no_file_imports_from_above():
    levels = floors()
    wrong = [
        f"{module(path)} imports {other}"
        for path in FILES
        for other in imported(path, KNOWN, for_types=True)
        if module(path) != "hitjoints"
        and other != "hitjoints"
        and height(KNOWN[other], levels) > height(path, levels)
    ]
    assert wrong == []


def test_no_circle_of_imports():
    graph = {module(path): imported(path, KNOWN, for_types=False) for path in FILES}
    try:
        list(TopologicalSorter(graph).static_order())
    except CycleError as error:
        pytest.fail(" -> ".join(error.args[1]))


def test_every_floor_is_there():
    for name in floors():
        assert (ROOT / name).exists(), name


def test_no_two_files_of_one_name():
    counts = Counter(path.name for path in FILES if not path.name.startswith("__"))
    assert [name for name, count in counts.items() if count > 1] == []


def test_no_two_classes_of_one_name():
    names = Counter(
        node.name
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text()))
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert [name for name, count in names.items() if count > 1] == []


def test_one_file_knows_proxsuite():
    users = [
        path.name
        for path in FILES
        if re.search(r"^\s*(from|import) proxsuite", path.read_text(), re.M)
    ]
    assert users == ["proxqp.py"]
