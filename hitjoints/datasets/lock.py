"""One writer at a time: a lock that ends with its process and leaves nothing behind."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def locked(folder: Path, *, wait: bool = False) -> Iterator[None]:
    """Lock a folder against other runs of hitjoints.

    Args:
        folder: that is there.
        wait: until the other lets go, instead of giving up.

    Raises:
        BlockingIOError: another run holds it.
    """
    handle = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    try:
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
        except BlockingIOError:
            raise
        except OSError:
            pass  # a file system without locks: what follows is as safe as it was there
        yield
    finally:
        os.close(handle)
