"""What a format is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ikplan.result import Plan

__all__ = ["Format"]


@dataclass(frozen=True)
class Format:
    """A way to write a plan.

    Attributes:
        name: Short name, such as ``csv``.
        title: One line for people.
        suffixes: File name endings that choose it, with the dot.
        media_type: Media type of the bytes.
        encode: From a plan to its bytes; the same plan gives the same bytes.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    media_type: str
    encode: Callable[[Plan], bytes]
