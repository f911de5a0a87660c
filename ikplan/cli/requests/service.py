"""The service that plans: named on the command line, or by the environment if it runs."""

from __future__ import annotations

import argparse
import os

from ikplan.cli.terminal.telling import tell
from ikplan.errors import InvalidRequest

__all__ = ["VARIABLE", "choose_service"]

VARIABLE = "IKPLAN_SERVER"
_PATIENCE_S = 0.5
_PORTS = {"http": 80, "https": 443}


def choose_service(options: argparse.Namespace) -> None:
    """Let the service of ``IKPLAN_SERVER`` plan where a command names none; ``--server ''``: none.

    The plan is the same wherever it is made. A missing service is reported, and planning
    goes on here; one that is named by ``--server`` has to be there.

    Raises:
        InvalidRequest: The variable holds no address.
    """
    if not getattr(options, "may_use_service", False):
        return
    if options.server is not None:
        options.server = options.server or None
        return
    address = os.environ.get(VARIABLE)
    if not address:
        return
    if _listens(address):
        options.server = address
    else:
        tell(options, f"no service at {address} ({VARIABLE}): planning here")


def _listens(address: str) -> bool:
    import socket
    from urllib.parse import urlsplit

    try:
        parts = urlsplit(address)
        place = (parts.hostname, parts.port or _PORTS.get(parts.scheme))
    except ValueError:
        place = (None, None)
    if None in place:
        raise InvalidRequest(
            f"{VARIABLE}={address}: an address such as http://127.0.0.1:8000 is allowed",
            field=VARIABLE,
            allowed="http://HOST:PORT",
        )
    try:
        socket.create_connection(place, timeout=_PATIENCE_S).close()
    except OSError:
        return False
    return True
