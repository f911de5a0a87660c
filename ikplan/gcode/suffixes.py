"""What files of G-code are called."""

from __future__ import annotations

__all__ = ["SUFFIXES"]

SUFFIXES = (".nc", ".gcode", ".ngc", ".cnc", ".tap")
"""Endings of the names of G-code files."""
