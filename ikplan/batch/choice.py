"""The executor of a name."""

from __future__ import annotations

from ikplan.batch.executor import Executor, Work
from ikplan.batch.local import LocalExecutor
from ikplan.errors import InvalidRequest

__all__ = ["executor_for"]


def executor_for(on: str, work: Work, workers: int = 0) -> Executor:
    """Return the executor that answers chunks of some work.

    Args:
        on: ``"local"``: worker processes of this machine; ``"ray"``: actors on a Ray cluster of
            this machine alone; ``"ray=ADDRESS"``: actors on the cluster of that address.
        work: What is done with the lines.
        workers: How many workers; 0: one a processor.

    Raises:
        InvalidRequest: No executor of that name, or Ray is not installed.
        ServiceUnavailable: There is no cluster at the address.
    """
    name, given, address = on.partition("=")
    if name == "local" and not given:
        return LocalExecutor(work, workers)
    if name == "ray" and bool(given) == bool(address):
        from ikplan.batch.on_ray import RayExecutor

        return RayExecutor(work, workers, address=address or None)
    raise InvalidRequest(
        f"--on: local, ray or ray=ADDRESS, not {on!r}",
        field="--on",
        allowed=["local", "ray", "ray=ADDRESS"],
    )
