"""Sphinx configuration."""

import sys
from pathlib import Path

from hitjoints.version import __version__

sys.path.insert(0, str(Path(__file__).parent / "extensions"))

project = "hitjoints"
author = "the hitjoints authors"
copyright = "2026, the hitjoints authors"
release = version = __version__
extensions = [
    "myst_nb",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "command_reference",
    "mathml",
]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented_params"
autodoc_member_order = "bysource"
napoleon_google_docstring = True
napoleon_use_ivar = True
nb_execution_mode = "off"  # shown as it was run; the tests run it again
html_theme = "furo"
html_title = "hitjoints"
html_math_renderer = "mathml"
html_static_path = ["static"]
html_css_files = ["pages.css"]
exclude_patterns = ["_build"]
