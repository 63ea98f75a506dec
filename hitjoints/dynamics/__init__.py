"""Quantities of an arm at one configuration, computed by Pinocchio."""
