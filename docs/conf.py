"""Sphinx configuration."""

from hitjoints.version import __version__

project = "hitjoints"
author = "the hitjoints authors"
copyright = "2026, the hitjoints authors"
release = version = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "amsmath", "colon_fence"]
myst_heading_anchors = 3
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
napoleon_google_docstring = True
napoleon_use_ivar = True
html_theme = "furo"
html_title = "hitjoints"
exclude_patterns = ["_build"]
