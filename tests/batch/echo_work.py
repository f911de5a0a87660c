"""Work that needs no kernels: for tests of who does it and of what is written."""

import json
import os
import signal
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from ikplan.batch.choice import executor_for
from ikplan.batch.chunks import Chunk, Line, Pace, chunks_of
from ikplan.batch.executor import Answers, Executor
from ikplan.batch.outcome import Outcome, failed
from ikplan.batch.output.formats import find_format
from ikplan.batch.output.shard_folder import ShardFolder
from ikplan.errors import InvalidRequest


@dataclass(frozen=True)
class EchoWork:
    """Answers a line with itself; ``{"kill": 9}`` ends the process, ``{"wrong": 1}`` is refused.

    Attributes:
        log: Folder in which every line that is answered leaves a byte; empty: none.
        seconds: How long a line takes [s].
    """

    log: str = ""
    seconds: float = 0.0
    preload: str = "ikplan.workers.child"

    def answer(self, lines: Sequence[bytes]) -> Answers:
        begun = time.perf_counter()
        return Answers([self._outcome(line) for line in lines], time.perf_counter() - begun)

    def _outcome(self, line: bytes) -> Outcome:
        document = json.loads(line)
        if self.log:
            with (Path(self.log) / str(document["k"])).open("ab") as answered:
                answered.write(b".")
        time.sleep(self.seconds)
        if "kill" in document:
            os.kill(os.getpid(), signal.SIGKILL)
        if "wrong" in document:
            return failed(InvalidRequest("wrong", field="wrong"))
        return Outcome(200, line)


def numbered(contents: Sequence[bytes]) -> Iterator[Line]:
    end = 0
    for index, content in enumerate(contents):
        end += len(content) + 1
        yield Line(index, content, end)


def answers_of(executor: Executor, contents: Sequence[bytes], size: int) -> list[Outcome]:
    """The answers of an executor to lines, in chunks of ``size``."""
    outcomes: list[Outcome] = []
    lines = tuple(numbered(contents))
    chunks = (Chunk(lines[k : k + size]) for k in range(0, len(lines), size))
    for done in executor.run(chunks):
        outcomes += done.outcomes
    return outcomes


def to_shards(
    folder: Path,
    contents: Sequence[bytes],
    work: EchoWork,
    form: str,
    size: int,
    on: str = "local",
) -> int:
    """Answer lines into a folder, whatever it has already; return the rows there."""
    output = ShardFolder(folder, find_format(form), size, {"kind": "echo"}, resume=True)
    executor = executor_for(on, work, 2)
    try:
        pace = Pace(2)
        for done in executor.run(chunks_of(output.remaining(numbered(contents)), pace)):
            for line, outcome in zip(done.chunk.lines, done.outcomes, strict=True):
                output.write(line, outcome)
        output.finish()
        return output.rows
    finally:
        executor.close()
        output.close()
