"""`python -m hitjoints.cli` is `hitjoints`."""

from . import main

if __name__ == "__main__":
    main()
