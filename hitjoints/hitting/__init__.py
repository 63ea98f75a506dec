"""The hitting motion."""
