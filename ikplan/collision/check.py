"""By which configurations and motions are refused: what the planner asks of a check for contact."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

from ikplan.arrays import Array, Flags
from ikplan.collision.bodies import Bodies
from ikplan.collision.scratch import Scratch
from ikplan.kinematics.chain import Chain

__all__ = ["Contact", "ContactArrays", "ContactCheck"]


class ContactArrays(NamedTuple):
    """What the kernels of a search take.

    Attributes:
        chain: The chain of the arm.
        bodies: Bodies to be kept apart.
        active: Which pairs of them count, shape (m,).
        margin: Gap asked for on top of the clearance [m].
        scratch: Work space.
    """

    chain: Chain
    bodies: Bodies
    active: Flags
    margin: float
    scratch: Scratch


@dataclass(frozen=True, eq=False)
class Contact:
    """Two bodies that come nearer than allowed.

    Attributes:
        step: Index of the configuration at which the motion to the next begins.
        share: Share of that motion at which they do.
        q: The configuration there, shape (dof,) [rad or m].
        pair: Names of the bodies.
    """

    step: int
    share: float
    q: Array
    pair: tuple[str, str]


class ContactCheck(Protocol):
    """Tells whether configurations, and motions between two of them, are free of contact."""

    @property
    def changes_by_segment(self) -> bool:
        """Whether bodies are attached on some segments only."""

    def wider(self, extra: float) -> ContactCheck:
        """Return the same check with a gap that is larger by ``extra`` asked for [m]."""

    def free(self, q: Array, segment: int | None = None) -> Flags:
        """Return which configurations, shape (m, dof) [rad or m], are free, shape (m,).

        ``segment`` is the one that they belong to; None: every body is there.
        """

    def pairs_in_contact(
        self, q: Array, segment: int | None = None
    ) -> list[tuple[str, str] | None]:
        """Return for each configuration a pair that is nearer than allowed, or None."""

    def tool_contact(self, q: Array, segment: int | None = None) -> tuple[str, str] | None:
        """Return a pair that is in contact wherever the tool is as at q, shape (dof,), or None."""

    def first_contact(self, q: Array, segment: int | None = None) -> Contact | None:
        """Return where straight joint motions from row to row first meet a body, or None."""

    def shortfall(self, q: Array, pair: tuple[str, str], segment: int | None = None) -> float:
        """Return by how much the gap of two bodies falls short of the clearance, or more [m]."""

    def contacts_on_curve(
        self, s: Array, q: Array, m: tuple[Array, Array], segment: int | None, extra: float
    ) -> Flags:
        """Return which pieces of a motion that is cubic from knot to knot are not proven free."""

    def arrays(self, segment: int | None) -> ContactArrays:
        """Return what the kernels of a search take, for the pairs that count in a segment."""
