"""Keys of the service: a secret for whoever asks, its hash for whoever checks."""

from __future__ import annotations

import hashlib
import secrets

__all__ = ["PREFIX", "key_hash", "new_key"]

PREFIX = "ikp_"
"""How every key begins, so that scanners for leaked secrets know one."""


def new_key() -> str:
    """Return a new key: 256 random bits, so that nobody can guess it or find it from its hash."""
    return PREFIX + secrets.token_urlsafe(32)


def key_hash(key: str) -> str:
    """Return the SHA-256 of a key, 64 hexadecimal digits: all that a service keeps of it."""
    return hashlib.sha256(key.encode()).hexdigest()
