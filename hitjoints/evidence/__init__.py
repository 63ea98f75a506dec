"""Judges of the numbers: a physics engine, recorded hits, the paper."""
