"""Motions as files that controllers read."""
