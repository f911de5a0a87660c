"""``ikplan batch``."""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
from collections import Counter
from collections.abc import Callable, Generator, Iterable, Iterator
from pathlib import Path
from typing import Any, BinaryIO

from ikplan.cli.requests.robot import name_robot
from ikplan.cli.terminal.exit_codes import NO_PLAN
from ikplan.cli.terminal.output import say
from ikplan.cli.terminal.progress import progress_bar
from ikplan.cli.terminal.telling import tell_start
from ikplan.documents import MAX_PLAN_S, load_json
from ikplan.documents.json_text import json_ready
from ikplan.errors import IkplanError, InvalidRequest

__all__ = ["batch"]

Answers = Generator[bytes | IkplanError, None, None]
"""For each line the plan, JSON, or why there is none."""


def batch(options: argparse.Namespace) -> int:
    """Plan every line of a file, here or by a service, and write a line for each.

    Returns:
        The exit code.

    Raises:
        InvalidRequest: There is no line, or an option makes no sense.
        OSError: A file cannot be read or written.
        ServiceUnavailable: The service cannot be reached, or stopped in between.
    """
    if options.workers < 0:
        raise InvalidRequest("--workers: 0 or more is allowed", field="--workers")
    lines = _read(options.requests)
    named: dict[str, Any] = {}
    tell_start(options, "loading")
    robot = name_robot(options, named)
    answers: Answers
    if robot is None or options.server:
        lines = [_for_robot(line, named) for line in lines]
    if options.server:
        answers = _by_service(options.server, lines)
    else:
        from ikplan.workers import plan_lines

        answers = plan_lines(lines, workers=options.workers, robot=robot)
    verdicts: Counter[str] = Counter()
    with contextlib.closing(answers), _written(options.output) as write, _bar(options) as tell:
        for index, answer in enumerate(answers):
            write(_line(index, answer))
            if isinstance(answer, IkplanError):
                verdicts[answer.slug] += 1
            tell(index + 1, len(lines))
    return _report(len(lines), verdicts, options)


def _read(name: str) -> list[bytes]:
    """The lines that are not blank; a file that cannot be read raises OSError."""
    data = sys.stdin.buffer.read() if name == "-" else Path(name).read_bytes()
    lines = [line for line in data.split(b"\n") if line.strip()]
    if not lines:
        raise InvalidRequest(
            "a batch has at least one line, a request in JSON", allowed="JSON lines"
        )
    return lines


def _for_robot(line: bytes, named: dict[str, Any]) -> bytes:
    """A line with the robot that all of them are for; one that makes no sense as it is."""
    if named:
        with contextlib.suppress(InvalidRequest):
            document = load_json(line)
            if isinstance(document, dict):
                return json.dumps({**document, **named}).encode()
    return line


def _by_service(url: str, lines: Iterable[bytes]) -> Answers:
    from ikplan.client import Client

    with Client(url, timeout=MAX_PLAN_S) as client:
        for outcome in client.batch(lines):
            if isinstance(outcome, IkplanError):
                yield outcome
            else:
                yield outcome.model_dump_json().encode()


def _line(index: int, answer: bytes | IkplanError) -> bytes:
    """The line of an answer, as a service writes it."""
    if isinstance(answer, bytes):
        return b'{"index": %d, "status": 200, "plan": %b}\n' % (index, answer)
    problem = json_ready(answer.to_problem())
    line = {"index": index, "status": problem["status"], "problem": problem}
    return json.dumps(line, allow_nan=False).encode() + b"\n"


@contextlib.contextmanager
def _written(file: str | None) -> Iterator[Callable[[bytes], None]]:
    """What writes lines, each at once, to a file or else to standard output."""
    with contextlib.ExitStack() as stack:
        out: BinaryIO
        out = sys.stdout.buffer if file is None else stack.enter_context(open(file, "wb"))

        def write(line: bytes) -> None:
            out.write(line)
            out.flush()

        yield write


@contextlib.contextmanager
def _bar(options: argparse.Namespace) -> Iterator[Callable[[int, int], None]]:
    """What tells how many lines are done; nothing where the lines themselves are seen."""
    if options.quiet or (options.output is None and sys.stdout.isatty()):
        yield lambda _done, _total: None
        return
    with progress_bar() as progress:
        yield lambda done, total: progress("batch", done, total) if progress else None


def _report(count: int, verdicts: Counter[str], options: argparse.Namespace) -> int:
    failed = verdicts.total()
    if options.output is not None and not options.quiet:
        say(f"{count - failed} of {count} requests planned", f"wrote {options.output}")
    if failed:
        reasons = ", ".join(f"{n} {slug}" for slug, n in sorted(verdicts.items()))
        sys.stderr.write(f"ikplan: {failed} of {count} requests have no plan: {reasons}\n")
        return NO_PLAN
    return 0
