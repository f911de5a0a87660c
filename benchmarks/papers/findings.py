"""What the report says first, written by hand after the full run."""

from __future__ import annotations

__all__ = ["CONTRADICTIONS", "DEFAULTS", "REPRODUCED"]

REPRODUCED = ""
CONTRADICTIONS = ""
DEFAULTS = ""
