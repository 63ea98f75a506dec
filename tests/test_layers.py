"""Data flows one way: a file imports from its own floor or one below."""

import ast
from pathlib import Path

import hitjoints

PACKAGE = Path(hitjoints.__file__).parent
FLOORS = [
    {"errors", "version", "tolerances"},
    {"vectors", "datasets"},
    {"robot", "urdf"},
    {"dynamics", "kernels"},
    {"modelcheck"},
    {"loading"},
    {"quantities", "programs"},
    {"hitting"},
    {"planning", "maps"},
    {"evidence"},
    {"show"},
]
FLOOR = {name: i for i, names in enumerate(FLOORS) for name in names}


def imports(tree: ast.Module, *, at_import_time: bool) -> set[str]:
    """Return the parts of hitjoints a file imports."""
    nodes = tree.body if at_import_time else ast.walk(tree)
    found = set()
    for node in nodes:
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("hitjoints."):
            found.add(node.module.split(".")[1])
    return found


def test_no_file_imports_from_above():
    wrong = []
    for path in PACKAGE.rglob("*.py"):
        part = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
        if part == "__init__":
            continue
        for other in imports(ast.parse(path.read_text()), at_import_time=True):
            if FLOOR[other] > FLOOR[part]:
                wrong.append(f"{path.relative_to(PACKAGE)} imports {other}")
    assert wrong == []


def test_one_file_knows_proxsuite():
    users = [p.name for p in PACKAGE.rglob("*.py") if "from proxsuite" in p.read_text()]
    assert users == ["proxqp.py"]
