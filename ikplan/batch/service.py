"""Chunks answered by a service."""

from __future__ import annotations

from collections.abc import Generator, Iterable

from ikplan.batch.chunks import Chunk, Done
from ikplan.batch.outcome import OK, Outcome, failed
from ikplan.client import Client
from ikplan.documents import MAX_PLAN_S
from ikplan.errors import IkplanError

__all__ = ["ServiceExecutor"]


class ServiceExecutor:
    """Plans by ``POST /v1/batches`` of a service.

    Args:
        url: The service.
        seconds: Whether plans tell how long their stages took.
    """

    def __init__(self, url: str, *, seconds: bool = True) -> None:
        self._client = Client(url, timeout=MAX_PLAN_S)
        self._seconds = seconds

    def run(self, chunks: Iterable[Chunk]) -> Generator[Done, None, None]:
        """Answer chunks, each line as soon as the service has; see Executor.run.

        Raises:
            ServiceUnavailable: The service cannot be reached, or stopped in between.
        """
        for chunk in chunks:
            answers = self._client.batch([line.content for line in chunk.lines])
            for line, answer in zip(chunk.lines, answers, strict=True):
                if isinstance(answer, IkplanError):
                    outcome = failed(answer)
                else:
                    if not self._seconds:
                        stats = answer.stats.model_copy(update={"seconds": {}})
                        answer = answer.model_copy(update={"stats": stats})
                    outcome = Outcome(OK, answer.model_dump_json().encode())
                yield Done(Chunk((line,)), [outcome], 0.0)

    def close(self) -> None:
        """Close the connection."""
        self._client.close()
