"""Hits in a physics engine (MuJoCo)."""
