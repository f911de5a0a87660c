"""Whose request it is."""

from __future__ import annotations

from fastapi import Request

__all__ = ["owner_of"]


def owner_of(request: Request) -> str:
    """Return the owner of what a request stores, reads, lists or deletes.

    It is the name of the request's key. Without keys, and where keys share the store, everything
    belongs to one owner, whose name is empty.
    """
    if request.app.state.settings.shared_store or request.app.state.store.shared:
        return ""
    return str(request.scope.get("state", {}).get("key") or "")
