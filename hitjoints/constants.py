"""Constants of nature, as everybody here uses them."""

GRAVITY = 9.81
"""m/s^2."""
