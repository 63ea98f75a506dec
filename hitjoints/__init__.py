"""Analytical dynamics for hitting objects with different joints of a robot arm."""

import lazy_loader

# The public names stand in __init__.pyi. `import hitjoints` costs milliseconds: each is loaded on
# first use.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
