"""Many requests, planned by processes of their own."""

from ikplan.workers.batch import plan_lines

__all__ = ["plan_lines"]
