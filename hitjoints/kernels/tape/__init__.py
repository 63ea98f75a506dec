"""Formulas recorded as straight-line programs, and what runs them."""
