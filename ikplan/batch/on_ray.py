"""Chunks answered by actors of a Ray cluster.

Each actor holds one worker process of the kind that batches here have, and watches it: a line that
ends its process costs only itself, with the same row. An actor that is lost with its machine is
replaced, and its lines are answered again.

Source: Moritz et al., "Ray: A Distributed Framework for Emerging AI Applications", OSDI 2018.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Generator, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from ikplan.batch.chunks import Chunk, Done
from ikplan.batch.executor import Answers, Work, run_on, supervised
from ikplan.batch.local import LocalWorker
from ikplan.errors import InvalidRequest, ServiceUnavailable, WorkerLost
from ikplan.workers.processors import processor_count

if TYPE_CHECKING:
    import ray

__all__ = ["RayExecutor"]

_ATTEMPTS = 3
_LOOPBACK = "127.0.0.1"
_CLUSTERS = "RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER"
"""Whether Ray may listen beyond loopback, on every system, whatever its name says."""


class RayExecutor:
    """Actors of a Ray cluster.

    Args:
        work: What is done with the lines.
        workers: How many actors; 0: one a processor of the cluster.
        address: Address of a cluster that runs; None: one of this machine alone, on loopback,
            which ends with this process.

    Raises:
        InvalidRequest: Ray is not installed.
        ServiceUnavailable: There is no cluster at the address.
    """

    def __init__(self, work: Work, workers: int = 0, address: str | None = None) -> None:
        if address is None:
            # Ray looks for an address that others can reach unless this is said before its import.
            os.environ.setdefault(_CLUSTERS, "0")
        try:
            import ray
        except ImportError as error:
            raise InvalidRequest(
                "--on ray needs Ray: pip install 'ikplan[ray]'", field="--on", allowed=["local"]
            ) from error
        self._ray = ray
        self._begun = not ray.is_initialized()
        if self._begun:
            _begin(ray, workers, address)
        count = workers or max(1, int(ray.cluster_resources().get("CPU", 1)))
        kind = ray.remote(num_cpus=1, max_restarts=0)(_Actor)
        self._workers = [_RayWorker(ray, kind, work) for _ in range(count)]

    def run(self, chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
        """Answer chunks, see :meth:`ikplan.batch.executor.Executor.run`."""
        yield from run_on(self._workers, chunks)

    def close(self) -> None:
        """End the actors, and the cluster if it was begun here."""
        if self._ray.is_initialized():
            for worker in self._workers:
                worker.stop()
            if self._begun:
                self._ray.shutdown()


def _begin(ray_: Any, workers: int, address: str | None) -> None:
    """Join a cluster, or begin one of this machine alone."""
    quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": "error"}
    # Actors find the same code as this process; threads of numeric libraries would only get into
    # each other's way.
    environment = {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    if address is None:
        ray_.init(
            num_cpus=workers or processor_count(),
            _node_ip_address=_LOOPBACK,
            runtime_env={"env_vars": environment},
            include_dashboard=False,
            **quiet,
        )
        _check_loopback(ray_)
        return
    try:
        ray_.init(address=address, **quiet)
    except (ConnectionError, ValueError, RuntimeError) as error:
        raise ServiceUnavailable(f"no Ray cluster at {address}: {error}") from error


def _check_loopback(ray_: Any) -> None:
    """End a cluster that others can reach: whoever reaches it can run code."""
    addresses = {node["NodeManagerAddress"] for node in ray_.nodes()}
    if addresses != {_LOOPBACK}:
        ray_.shutdown()
        raise ServiceUnavailable(
            f"Ray would listen on {', '.join(sorted(addresses))} instead of {_LOOPBACK}: set "
            f"{_CLUSTERS}=0 before Ray is imported, or begin a cluster and name its address"
        )


class _Actor:
    """What runs on the cluster: one worker process, watched."""

    def __init__(self, work: Work) -> None:
        self._worker = LocalWorker(work)

    def answer(self, lines: list[bytes]) -> Answers:
        return supervised(self._worker, lines)


class _RayWorker:
    """One actor, replaced when it is lost."""

    def __init__(self, ray_: Any, kind: Any, work: Work) -> None:
        self._ray, self._kind, self._work = ray_, kind, work
        self._actor: ray.actor.ActorHandle | None = None

    def answer(self, lines: Sequence[bytes]) -> Answers:
        lost: Exception | None = None
        for _ in range(_ATTEMPTS):
            if self._actor is None:
                self._actor = self._kind.remote(self._work)
            try:
                answers: Answers = self._ray.get(self._actor.answer.remote(list(lines)))
            except self._ray.exceptions.RayActorError as error:
                lost, self._actor = error, None
            else:
                return answers
        raise WorkerLost(
            f"the actor was lost {_ATTEMPTS} times; other requests are not affected", exit_code=1
        ) from lost

    def stop(self) -> None:
        """End the actor, in the middle of what it does."""
        if self._actor is not None:
            self._ray.kill(self._actor)
            self._actor = None
