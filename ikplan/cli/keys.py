"""``ikplan keys``."""

from __future__ import annotations

import argparse
import re

from ikplan.cli.terminal.output import say
from ikplan.client.api_keys import key_hash, new_key
from ikplan.errors import InvalidRequest

__all__ = ["new"]

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
    say(f"key, for the client:    {key}")
    say(f"hash, for the service:  IKPLAN_API_KEYS={entry}")
