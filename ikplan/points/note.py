"""What is said of how a file was read."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["Note"]


class Note(NamedTuple):
    """One thing to say.

    Attributes:
        text: In words.
        guessed: The file does not say it: it follows from the values.
    """

    text: str
    guessed: bool = False
