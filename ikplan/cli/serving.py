"""``ikplan serve``."""

from __future__ import annotations

import argparse
import contextlib
import logging.config
import os
import resource
import socket
import sys
from typing import Any

from ikplan.errors import InvalidRequest

__all__ = ["serve"]

APP = "ikplan_api.app:create_app"
PROTOCOL = "ikplan_api.connections.protocol:BoundedProtocol"
_ACCEPTED_AT_ONCE = 32
_DESCRIPTORS = 65536
_KEEP_ALIVE_S = 75
"""Time that idle connections are kept [s]: longer than clients keep them, so that none asks on one
that is just being closed."""


def serve(options: argparse.Namespace) -> None:
    """Serve until interrupted.

    Raises:
        InvalidRequest: A port or setting is not allowed.
        OSError: The address cannot be listened on.
    """
    if not 0 <= options.port <= 65535:
        raise InvalidRequest("--port: 0..65535 is allowed", field="--port", allowed="0..65535")
    import uvicorn

    from ikplan.cli.server import Server

    config = uvicorn.Config(
        APP,
        factory=True,
        host=options.host,
        port=options.port,
        log_config=None,
        timeout_keep_alive=_KEEP_ALIVE_S,
        http=PROTOCOL,
        ws="none",
        # Also the number of connections accepted before those that wait are looked at.
        backlog=_ACCEPTED_AT_ONCE,
        access_log=False,  # the service tells more of each request itself
    )
    _raise_descriptor_limit()
    with _listen(options.host, options.port) as listening:
        # The service reads its settings from the environment, however it is started.
        os.environ["IKPLAN_HOST"], os.environ["IKPLAN_PORT"] = options.host, str(options.port)
        if options.workers is not None:
            os.environ["IKPLAN_WORKERS"] = str(options.workers)
        os.environ.setdefault("OTEL_SERVICE_NAME", "ikplan")  # what traces call it
        config.load()
        logging.config.dictConfig(_logging())
        sys.stderr.write(f"ikplan: listening on {_address(listening)} (manual at /docs)\n")
        with contextlib.suppress(KeyboardInterrupt):
            Server(config).run(sockets=[listening])


def _logging() -> dict[str, Any]:
    """How to log, for :mod:`logging`; a level that does not exist is for the service to refuse."""
    level = os.environ.get("IKPLAN_LOG_LEVEL", "info").upper()
    known = level in ("DEBUG", "INFO", "WARNING", "ERROR")
    return {
        "version": 1,
        "disable_existing_loggers": False,
        "filters": {"request": {"()": "ikplan_api.telemetry.logs.RequestFilter"}},
        "formatters": {"chosen": {"()": "ikplan_api.telemetry.logs.formatter"}},
        "handlers": {
            "stderr": {
                "class": "logging.StreamHandler",
                "formatter": "chosen",
                "filters": ["request"],
            }
        },
        "root": {"handlers": ["stderr"], "level": "WARNING"},
        "loggers": {
            **{name: {"level": level if known else "INFO"} for name in ("ikplan", "uvicorn")},
            # Named, or its parent above would let it speak again: a second line a request.
            "uvicorn.access": {"level": "WARNING"},
        },
    }


def _raise_descriptor_limit() -> None:
    """Let the process open as many files as it may: connections and workers need them."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, _DESCRIPTORS)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        with contextlib.suppress(OSError, ValueError):  # then fewer connections
            resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


def _address(listening: socket.socket) -> str:
    host, port = listening.getsockname()[:2]
    return f"http://[{host}]:{port}" if ":" in host else f"http://{host}:{port}"


def _listen(host: str, port: int) -> socket.socket:
    """Take the address before anything else, so that a wrong one is reported at once."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    try:
        listening = socket.create_server((host, port), family=family)
    except OSError as error:
        reason = error.strerror or str(error)
        raise OSError(error.errno, f"cannot listen on {host} port {port}: {reason}") from error
    # Connections inherit it. The event loop sets it on those only whose protocol it is told, which
    # sockets made in Python do not tell; without it a short answer waits 40 ms for its second half.
    listening.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return listening
