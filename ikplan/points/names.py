"""Names that a request for a file of points chooses among."""

from __future__ import annotations

__all__ = ["INTERPOLATIONS", "TOOL_AXES"]

INTERPOLATIONS = ("joint", "line", "spline")
"""How points are joined."""
TOOL_AXES = ("x", "y", "z", "-x", "-y", "-z")
"""Axes of the tool about which it may turn."""
