"""The open connections, bounded in number in all and by address."""

from __future__ import annotations

import resource
from collections import Counter
from enum import Enum
from typing import NamedTuple, Protocol

from ikplan.errors import InvalidRequest

__all__ = ["LEAST_RATE", "Connection", "ConnectionLimits", "Connections", "Phase", "most_open"]

LEAST_RATE = 16 * 1024
"""Rate from which a body may take longer than its time limit [bytes/s]."""
_OWN_DESCRIPTORS = 64
"""Descriptors that the service keeps for itself: files, logs, the store, builds of robots."""
_WORKER_DESCRIPTORS = 16
"""Descriptors for each worker process and its replacement."""
_FEWEST = 8


class Phase(Enum):
    """What a connection waits for."""

    HEADER = "header"
    BODY = "body"
    ANSWER = "answer"
    IDLE = "idle"


class ConnectionLimits(NamedTuple):
    """Bounds of connections.

    Attributes:
        header_s: Time for the header of a request [s].
        body_s: Time for its body [s], longer for bodies faster than :data:`LEAST_RATE`.
        send_s: Time in which a client must take some of its answer [s].
        most: Largest number of connections.
        most_per_address: Largest number of connections of one address.
    """

    header_s: float = 10.0
    body_s: float = 30.0
    send_s: float = 30.0
    most: int = 1000
    most_per_address: int = 500


class Connection(Protocol):
    """A connection as its registry knows it."""

    @property
    def address(self) -> str:
        """Address of the client."""

    @property
    def phase(self) -> Phase:
        """What it waits for."""

    @property
    def last_heard(self) -> float:
        """When its client last sent something, or connected [s]."""

    def evict(self) -> None:
        """Close it in favour of a newer one."""

    def refuse(self) -> None:
        """Close it because the service has no room for it."""


class Connections:
    """Keeps the open connections and closes surplus ones.

    A new connection is accepted if there is room. Else one that only waits for its client, idle or
    in the middle of a request, is closed for it, namely the one not heard of for longest: clients
    that send slowly cannot keep others out, and are no match for one that sends. If every
    connection waits for the service, the new one is refused.

    Args:
        limits: The bounds.

    Attributes:
        limits: The bounds.
        closed: Number of connections closed by the service, by reason.
    """

    def __init__(self, limits: ConnectionLimits) -> None:
        self.limits = limits
        self.closed: Counter[str] = Counter()
        self._open: dict[Connection, None] = {}  # in the order of their arrival
        self._by_address: Counter[str] = Counter()

    def __len__(self) -> int:
        return len(self._open)

    def admit(self, new: Connection) -> None:
        """Add a connection, and close another one or the new one if there are too many."""
        self._open[new] = None
        self._by_address[new.address] += 1
        if self._by_address[new.address] > self.limits.most_per_address:
            self._make_room(new, new.address)
        elif len(self._open) > self.limits.most:
            self._make_room(new, None)

    def discard(self, connection: Connection) -> None:
        """Remove a connection that is closed or about to be closed."""
        if connection not in self._open:
            return
        del self._open[connection]
        address = connection.address
        self._by_address[address] -= 1
        if not self._by_address[address]:
            del self._by_address[address]

    def _make_room(self, new: Connection, address: str | None) -> None:
        waiting = [
            known
            for known in self._open
            if known is not new
            and known.phase is not Phase.ANSWER
            and (address is None or known.address == address)
        ]
        if waiting:
            chosen = min(waiting, key=lambda known: known.last_heard)
            self.discard(chosen)
            self.closed["evicted"] += 1
            chosen.evict()
            return
        self.discard(new)
        self.closed["refused"] += 1
        new.refuse()


def most_open(wanted: int, workers: int) -> int:
    """Return the number of connections that the process's descriptors allow, at most ``wanted``.

    Raises:
        InvalidRequest: The descriptors do not suffice for the service itself.
    """
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    if soft == resource.RLIM_INFINITY:
        return wanted
    needed = _OWN_DESCRIPTORS + _WORKER_DESCRIPTORS * workers
    if soft < needed + _FEWEST:
        raise InvalidRequest(
            f"the process may open {soft} files, and {workers} workers and {_FEWEST} connections "
            f"need {needed + _FEWEST}; raise the limit (ulimit -n), or lower IKPLAN_WORKERS",
            field="IKPLAN_WORKERS",
            allowed=f"at least {needed + _FEWEST} descriptors",
        )
    return min(wanted, soft - needed)
