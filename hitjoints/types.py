"""Types that every room uses."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Floating-point numbers; what shape they have is said where they are used."""
