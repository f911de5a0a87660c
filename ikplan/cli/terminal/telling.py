"""What a command tells on stderr beside its answer: that it works, and how it read a file."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ikplan.points.note import Note

__all__ = ["tell", "tell_notes", "tell_start"]


def tell(options: argparse.Namespace, text: str) -> None:
    """Tell something, unless ``-q`` asks for silence."""
    if not options.quiet:
        sys.stderr.write(f"ikplan: {text}\n")
        sys.stderr.flush()


def tell_start(options: argparse.Namespace, what: str) -> None:
    """Give a sign of life before something slow is imported; to people only."""
    if options.verbose or sys.stderr.isatty():
        tell(options, f"{what} ...")


def tell_notes(options: argparse.Namespace, notes: Iterable[Note]) -> None:
    """Tell how a file of points was read."""
    for note in notes:
        tell(options, note.text)
