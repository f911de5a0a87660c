"""``ikplan keys``."""

from __future__ import annotations

import argparse
import itertools
import re

from ikplan.cli.plans import server_of
from ikplan.cli.terminal.output import say, say_json, table
from ikplan.client.api_keys import key_hash, new_key
from ikplan.errors import InvalidRequest

__all__ = ["audit", "new"]

_NAME = re.compile(r"[A-Za-z0-9_.-]{1,64}")


def new(options: argparse.Namespace) -> None:
    """Make a key, and tell it once, with what the service has to know of it.

    Raises:
        InvalidRequest: The name has characters that are not allowed.
    """
    if options.name is not None and not _NAME.fullmatch(options.name):
        raise InvalidRequest(
            "--name: 1 to 64 letters, digits, '_', '.' and '-' are allowed", field="--name"
        )
    key = new_key()
    entry = key_hash(key) if options.name is None else f"{options.name}:{key_hash(key)}"
    for name in ("role", "rate", "jobs"):
        value = getattr(options, name)
        if value is not None:
            entry += f";{name}={value}"
    if ";" in entry:
        entry = f"'{entry}'"
    say(f"key, for the client:    {key}")
    say(f"hash, for the service:  IKPLAN_API_KEYS={entry}")


def audit(options: argparse.Namespace) -> None:
    """Tell who planned what; the key in use needs the role auditor.

    Raises:
        AccessDenied: The key may not ask.
        InvalidRequest: An option makes no sense.
        ServiceUnavailable: The service cannot be reached.
    """
    from ikplan.client import Client

    with Client(server_of(options)) as client:
        entries = list(itertools.islice(client.audit(owner=options.owner), max(0, options.limit)))
    if options.json:
        say_json({"entries": [entry.model_dump(mode="json") for entry in entries]})
        return
    rows = [(e.time, e.owner or "-", e.action, e.id, e.robot or "-") for e in entries]
    say(*table(("time", "key", "action", "id", "robot"), rows, left=5))
