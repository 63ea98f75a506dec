import subprocess
import sys

import pytest
from markdown_pages import ROOT


@pytest.fixture(scope="session")
def built(tmp_path_factory):
    """Return the folder of the pages, built as `make docs` does."""
    folder = tmp_path_factory.mktemp("html")
    build = [sys.executable, "-m", "sphinx", "-W", "-q", "-b", "html", ROOT / "docs", folder]
    run = subprocess.run(build, capture_output=True, text=True, check=False)
    assert run.returncode == 0, run.stderr
    return folder
