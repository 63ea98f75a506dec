"""Recorded hits of real arms."""
