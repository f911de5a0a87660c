"""Many requests, planned by processes of their own."""

from ikplan.batch.lines import plan_lines

__all__ = ["plan_lines"]
