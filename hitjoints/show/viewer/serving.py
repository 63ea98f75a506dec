"""How a server lives: it keeps stdout clean, serves on an address of ours, and ends when told."""

from __future__ import annotations

import io
import signal
import socket
import threading
from contextlib import redirect_stdout
from typing import TYPE_CHECKING

from hitjoints.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

ENDS = (signal.SIGINT, signal.SIGTERM)


def silence() -> redirect_stdout[io.StringIO]:
    """Keep stdout clean: viser writes there, told to be quiet or not."""
    return redirect_stdout(io.StringIO())


def check_address(host: str, port: int) -> None:
    """Refuse an address that is not this machine's: viser would wait for ever.

    Raises:
        InputError: it cannot be served on.
    """
    if not 0 < port < 65536:
        raise InputError("port", port, "a port is from 1 to 65535")
    try:
        with socket.socket() as probe:
            probe.bind((host, 0))
    except OSError as error:
        raise InputError("host", host, f"it cannot be served on ({error.strerror})") from None


def until_told(ready: Callable[[], None]) -> None:
    """Wait until a signal asks to end, SIGINT or SIGTERM, also where SIGINT is ignored.

    Args:
        ready: called when signals are waited for.
    """
    over = threading.Event()
    main = threading.current_thread() is threading.main_thread()
    before = {one: signal.signal(one, lambda *_: over.set()) for one in ENDS if main}
    try:
        ready()
        over.wait()
    finally:
        for one, handler in before.items():
            signal.signal(one, handler)
