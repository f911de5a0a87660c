"""The result of tracking a tool path: the configurations, or where tracking failed."""

from __future__ import annotations

from dataclasses import dataclass

from ikplan.arrays import Array, Indices
from ikplan.collision.check import Contact

__all__ = ["TrackedPath", "TrackingFailed", "in_contact"]


@dataclass(frozen=True)
class TrackedPath:
    """Points of a path that was tracked to its end.

    Attributes:
        s: Path positions, shape (m,).
        q: Configurations, shape (m, dof) [rad or m].
        rest: Indices of the points where the motion stops.
        waypoint: Indices of the points of the waypoints, shape (n,).
        length: Sum of the joint distances, the move to the first point included.
    """

    s: Array
    q: Array
    rest: list[int]
    waypoint: Indices
    length: float


class TrackingFailed(Exception):
    """The arm cannot track the path any farther.

    Attributes:
        s: Path position of the last point reached.
        q: Its configuration, shape (dof,) [rad or m].
        beyond: The configuration next on the path, which it cannot move on to, shape (dof,); None:
            none was found.
        contact: Where the arm meets a body; None: it is not contact that ends the path.
    """

    def __init__(
        self,
        s: float,
        q: Array,
        beyond: Array | None = None,
        contact: Contact | None = None,
    ) -> None:
        super().__init__(f"lost the path at {s:.6g}")
        self.s = s
        self.q = q
        self.beyond = beyond
        self.contact = contact


def in_contact(contact: Contact, s: Array) -> TrackingFailed:
    """Return the failure of a path that is tracked up to a contact."""
    at = float(s[contact.step])
    if contact.step + 1 < len(s):
        at += contact.share * float(s[contact.step + 1] - s[contact.step])
    return TrackingFailed(at, contact.q.copy(), contact=contact)
