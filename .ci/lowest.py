"""Print pip constraints that pin what pyproject.toml asks for to the lowest versions it allows.

Usage: python .ci/lowest.py [EXTRA...], for the dependencies and those of the named extras.
"""

import re
import sys
import tomllib
from pathlib import Path

FLOOR = re.compile(r"(?P<name>[\w.-]+)>=(?P<version>[\w.]+)(?P<marker>\s*;.*)?")

project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
asked = set(project["dependencies"])
for extra in sys.argv[1:]:
    asked |= set(project["optional-dependencies"][extra])
for requirement in sorted(asked):
    floor = FLOOR.fullmatch(requirement)
    if floor is None:
        sys.exit(f"pyproject.toml: no lowest version in {requirement!r}")
    print(f"{floor['name']}=={floor['version']}{floor['marker'] or ''}")
