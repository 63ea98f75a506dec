"""The command line: `hitjoints COMMAND`, one file per command."""

from .border import main

__all__ = ["main"]
