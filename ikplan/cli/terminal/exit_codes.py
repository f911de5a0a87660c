"""Exit codes of a command that fails."""

from __future__ import annotations

__all__ = ["INTERNAL", "NO_PLAN", "WRONG_INPUT"]

NO_PLAN = 1
"""The request makes sense, and there is no plan; or not one for all of a batch."""
WRONG_INPUT = 2
"""Wrong usage or input."""
INTERNAL = 3
"""The service cannot be reached or refuses, or a fault of ours."""
