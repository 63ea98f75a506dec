"""Figures, drawn with matplotlib."""

from . import figures as figures
