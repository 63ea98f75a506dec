"""The command line: `hitjoints COMMAND`, one file per command."""

from .app import main

__all__ = ["main"]
