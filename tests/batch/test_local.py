"""Local worker processes: in order, bounded in flight, and a line costs only itself."""

import itertools
import json
from collections.abc import Iterator
from pathlib import Path

from ikplan.batch.chunks import Chunk, Line, Pace, chunks_of
from ikplan.batch.local import LocalExecutor
from tests.batch.echo_work import EchoWork, answers_of, numbered


def test_a_line_that_ends_its_worker_costs_only_itself(tmp_path: Path) -> None:
    lines = [b'{"k": %d}' % k for k in range(20)]
    lines[5] = b'{"k": 5, "kill": 9}'
    lines[11] = b'{"k": 11, "wrong": 1}'
    executor = LocalExecutor(EchoWork(str(tmp_path)), 2)
    outcomes = answers_of(executor, lines, 4)
    assert [o.status for o in outcomes] == [500 if k == 5 else 422 if k == 11 else 200
                                            for k in range(20)]  # fmt: skip
    assert outcomes[5].slug == "worker-lost"
    assert json.loads(outcomes[5].document)["exit_code"] == -9
    others = [o.document for k, o in enumerate(outcomes) if k not in (5, 11)]
    assert others == [line for k, line in enumerate(lines) if k not in (5, 11)]
    # In a chunk and alone, and never again.
    assert (tmp_path / "5").read_bytes() == b".."
    # Of the other chunks every line is answered once.
    assert all((tmp_path / str(k)).read_bytes() == b"." for k in range(8, 20))


def test_no_more_lines_are_taken_than_a_few_chunks_for_each_worker() -> None:
    taken = 0

    def endless() -> Iterator[Chunk]:
        nonlocal taken
        for k in itertools.count():
            taken += 1
            yield Chunk((Line(k, b'{"k": %d}' % k, 0),))

    executor = LocalExecutor(EchoWork(), 2)
    answers = executor.run(endless())
    try:
        for k, done in enumerate(itertools.islice(answers, 40)):
            assert done.outcomes[0].document == b'{"k": %d}' % k
            assert taken <= k + 1 + 8
    finally:
        answers.close()


def test_chunks_grow_until_they_take_a_second() -> None:
    pace = Pace()
    sizes = []
    for chunk in chunks_of(numbered([b"{}"] * 5000), pace):
        sizes.append(len(chunk.lines))
        pace.note(len(chunk.lines), 0.002 * len(chunk.lines))
    assert sum(sizes) == 5000
    assert sizes[:5] == [1, 4, 16, 64, 256]
    assert set(sizes[5:-1]) == {500}
    pace.note(10, 100.0)
    assert pace.lines == 1
