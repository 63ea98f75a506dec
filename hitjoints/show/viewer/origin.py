"""Who may open the browser's connection: pages that this server itself has served.

Any page in a browser can reach a server on the same machine, and would press its buttons. A browser
says in `Origin` where a page came from; programs that are no browsers say nothing and are let in.
"""

from __future__ import annotations

import inspect
import ipaddress
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from typing import Any
from urllib.parse import urlsplit

_PATCHING = threading.Lock()


def is_foreign(origin: str | None, asked: str | None, served_as: str) -> bool:
    """Tell whether a page may not connect.

    Args:
        origin: of the page, such as "http://127.0.0.1:8080"; None when it is no browser's.
        asked: what the browser calls this server, the header Host.
        served_as: the address that is served on.

    Returns:
        True unless the page came from here, under a name that is this machine's: another name may
        have been pointed at this address by whoever owns it (DNS rebinding).
    """
    if origin is None:
        return False
    try:
        page, host = urlsplit(origin), urlsplit(f"//{asked or ''}")
        same = page.scheme in ("http", "https") and page.netloc == host.netloc
        name = host.hostname or ""
    except ValueError:
        return True
    return not (same and (_is_address(name) or name in _own_names(served_as)))


def _is_address(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


def _own_names(served_as: str) -> set[str]:
    here = socket.gethostname().lower()
    return {"localhost", served_as.lower(), here, f"{here}.local", socket.getfqdn().lower()}


@contextmanager
def own_pages_only(host: str) -> Iterator[None]:
    """Let the server that is started inside refuse foreign pages; viser has no option for it."""
    from websockets.asyncio import server

    plain = server.serve

    def guarded(*arguments: Any, process_request: Any, **options: Any) -> Any:
        async def judged(connection: Any, request: Any) -> Any:
            headers = request.headers
            opens = headers.get("Upgrade", "").lower() == "websocket"
            if opens and is_foreign(headers.get("Origin"), headers.get("Host"), host):
                return connection.respond(HTTPStatus.FORBIDDEN, "This page is not served here.\n")
            answer = process_request(connection, request)
            return await answer if inspect.isawaitable(answer) else answer

        return plain(*arguments, process_request=judged, **options)

    with _PATCHING:
        server.serve = guarded  # type: ignore[assignment,misc]
        try:
            yield
        finally:
            server.serve = plain  # type: ignore[misc]
