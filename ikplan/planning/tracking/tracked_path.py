"""The result of tracking a tool path: the configurations, or where tracking failed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from ikplan.arrays import Array, Indices
from ikplan.collision.check import Contact

__all__ = [
    "JointSequence",
    "TrackedPath",
    "TrackedStarts",
    "TrackingFailed",
    "farthest_failure",
    "in_contact",
    "shortest_first",
]

JointSequence = tuple[float, Array, Array]
"""Cost, path positions, shape (m,), and configurations, shape (m, dof)."""

_DIGITS = 9
"""Digits after the point to which lengths of sequences are compared."""


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
        way: Path positions, shape (m,), and configurations, shape (m, dof), tracked up to there;
            None: they are not known.
    """

    def __init__(
        self,
        s: float,
        q: Array,
        beyond: Array | None = None,
        contact: Contact | None = None,
        way: tuple[Array, Array] | None = None,
    ) -> None:
        super().__init__(f"lost the path at {s:.6g}")
        self.s = s
        self.q = q
        self.beyond = beyond
        self.contact = contact
        self.way = way


def in_contact(contact: Contact, s: Array) -> TrackingFailed:
    """Return the failure of a path that is tracked up to a contact."""
    at = float(s[contact.step])
    if contact.step + 1 < len(s):
        at += contact.share * float(s[contact.step + 1] - s[contact.step])
    return TrackingFailed(at, contact.q.copy(), contact=contact)


def farthest_failure(a: TrackingFailed | None, b: TrackingFailed | None) -> TrackingFailed | None:
    """Whichever got farther along the path; the first of those that got equally far.

    What is tracked to the end but for contact counts before what is not: obstacles hold it alone.
    """
    if a is None or b is None:
        return b if a is None else a
    return b if (b.contact is not None, b.s) > (a.contact is not None, a.s) else a


def shortest_first(sequences: Sequence[JointSequence]) -> list[JointSequence]:
    """Sequences in order of their length; equally long ones, but for rounding, as they are."""
    return sorted(sequences, key=lambda sequence: round(sequence[0], _DIGITS))


@dataclass(frozen=True, eq=False)
class TrackedStarts:
    """What a path was tracked to from each start, and which of that is free of contact.

    Only the shortest sequences are needed, and to look for contact costs more than to track: it
    is looked for where a sequence, or the failure that got farthest, is asked for.

    Attributes:
        ends: What each start led to, in order.
        contact: Looks for contact between the points of a sequence.
    """

    ends: Sequence[JointSequence | TrackingFailed]
    contact: Callable[[Array, Array], Contact | None]
    _met: dict[int, Contact | None] = field(default_factory=dict)

    @property
    def lost(self) -> list[TrackingFailed]:
        """The failures of those starts from which the path was lost before its end."""
        return [end for end in self.ends if isinstance(end, TrackingFailed)]

    def clear(self, most: int | None = None) -> list[JointSequence]:
        """Return the sequences free of contact, shortest first.

        Args:
            most: How many of them at most; None: all.
        """
        sequences = [end for end in self.ends if not isinstance(end, TrackingFailed)]
        found: list[JointSequence] = []
        for sequence in shortest_first(sequences):
            if len(found) == most:
                break
            if self._contact_of(sequence) is None:
                found.append(sequence)
        return found

    def farthest(self) -> TrackingFailed | None:
        """Return the failure that got farthest; None: all are free of contact to their ends."""
        farthest: TrackingFailed | None = None
        for end in self.ends:
            if isinstance(end, TrackingFailed):
                farthest = farthest_failure(farthest, end)
            elif contact := self._contact_of(end):
                farthest = farthest_failure(farthest, in_contact(contact, end[1]))
        return farthest

    def _contact_of(self, sequence: JointSequence) -> Contact | None:
        if id(sequence) not in self._met:
            self._met[id(sequence)] = self.contact(sequence[1], sequence[2])
        return self._met[id(sequence)]
