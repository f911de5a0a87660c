"""``ikplan batch``."""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.batch.chunks import Line, Pace, chunks_of
from ikplan.batch.input import Input, count_lines, open_input
from ikplan.cli.requests.robot import name_robot
from ikplan.cli.terminal.batch_progress import BatchProgress
from ikplan.cli.terminal.exit_codes import NO_PLAN
from ikplan.cli.terminal.output import say
from ikplan.cli.terminal.telling import tell_start
from ikplan.documents import load_json
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.batch.executor import Executor
    from ikplan.batch.output import BatchOutput
    from ikplan.robots import Robot

__all__ = ["batch"]

_SHARD_LINES = {"plan": 128, "move": 64, "time": 256, "ik": 10_000}
"""Rows of a shard by kind of request: a few seconds of work."""
_RESULT = {"plan": "planned", "move": "planned", "time": "timed", "ik": "solved"}
_SERVICE_LINES = 256
"""Lines that a service gets at a time."""


def batch(options: argparse.Namespace) -> int:
    """Answer every line of a file, here, on a cluster or by a service; write a row for each.

    Returns:
        The exit code.

    Raises:
        InvalidRequest: There is no line, or an option makes no sense.
        OSError: A file cannot be read or written.
        ServiceUnavailable: The service cannot be reached, or stopped in between.
    """
    _check(options)
    named: dict[str, Any] = {}
    tell_start(options, "loading")
    with contextlib.ExitStack() as stack:
        lines = stack.enter_context(open_input(options.requests))
        robot = name_robot(options, named)
        output = stack.enter_context(contextlib.closing(_output(options, robot)))
        executor = stack.enter_context(contextlib.closing(_executor(options, robot)))
        _answer(options, lines, named, robot, output, executor)
        return _report(output, options)


def _check(options: argparse.Namespace) -> None:
    for name, least in (("workers", 0), ("shard_lines", 1)):
        value = getattr(options, name)
        if value is not None and value < least:
            option = f"--{name.replace('_', '-')}"
            raise InvalidRequest(f"{option}: {least} or more is allowed", field=option)
    if options.kind not in _SHARD_LINES:
        raise InvalidRequest(
            f"--kind: one of {', '.join(_SHARD_LINES)}, not {options.kind!r}",
            field="--kind",
            allowed=list(_SHARD_LINES),
        )
    if options.server and options.kind != "plan":
        raise InvalidRequest(
            f"--server answers batches of plans; --kind {options.kind} is answered without it",
            field="--kind",
            allowed="plan",
        )
    if options.resume and options.output is None:
        raise InvalidRequest("--resume continues the output that -o names", field="--resume")


def _is_folder(output: str) -> bool:
    return output.endswith("/") or Path(output).is_dir()


def _output(options: argparse.Namespace, robot: Robot | None) -> Any:
    """Where the rows go; has ``close`` beside what a BatchOutput has."""
    from ikplan.batch.output.row_file import RowFile, RowStream, begin_row_file

    if options.output is None:
        return RowStream(sys.stdout.buffer)
    file = Path(options.output)
    if not _is_folder(options.output):
        for option in ("format", "shard_lines"):
            if getattr(options, option) is not None:
                name = f"--{option.replace('_', '-')}"
                raise InvalidRequest(f"{name} belongs to a folder: -o {file}/", field=name)
        if options.resume:
            return RowFile(file, resume=True)
        return begin_row_file(file, lambda: count_lines(options.requests))
    return _shards(options, robot, file)


def _shards(options: argparse.Namespace, robot: Robot | None, folder: Path) -> Any:
    from ikplan._version import __version__
    from ikplan.batch.output.formats import find_format
    from ikplan.batch.output.shard_folder import ShardFolder

    form = options.format or "jsonl.zst"
    described = {
        "kind": options.kind,
        "format": form,
        "robot": options.robot_override if robot is None else robot.fingerprint,
        "version": __version__,
    }
    shard_lines = options.shard_lines or _SHARD_LINES[options.kind]
    return ShardFolder(folder, find_format(form), shard_lines, described, resume=options.resume)


def _executor(options: argparse.Namespace, robot: Robot | None) -> Executor:
    """Who answers."""
    # Shards hold the same bytes whenever they are made: no measured times.
    seconds = options.output is None or not _is_folder(options.output)
    if options.server:
        from ikplan.batch.service import ServiceExecutor

        return ServiceExecutor(options.server, seconds=seconds)
    from ikplan.batch.choice import executor_for
    from ikplan.batch.requests import RequestWork

    return executor_for(options.on, RequestWork(options.kind, robot, seconds), options.workers)


def _answer(
    options: argparse.Namespace,
    lines: Input,
    named: dict[str, Any],
    robot: Robot | None,
    output: BatchOutput,
    executor: Executor,
) -> None:
    """Have every line answered that has no row yet."""
    pace = Pace(_SERVICE_LINES if options.server else None)
    given: Iterable[Line] = lines
    if robot is None or options.server:
        given = _for_robot(given, named)
    watched = options.output is not None or not sys.stdout.isatty()
    progress = BatchProgress(lines.size, quiet=options.quiet or not watched)
    with contextlib.closing(progress), contextlib.ExitStack() as stack:
        begin = 0
        answers = executor.run(chunks_of(output.remaining(given), pace))
        stack.callback(executor.close)
        for done in answers:
            pace.note(len(done.outcomes), done.seconds)
            for line, outcome in zip(done.chunk.lines, done.outcomes, strict=True):
                output.write(line, outcome)
                progress.tell(output.rows, output.verdicts, begin, line.end)
                begin = line.end
        output.finish()


def _for_robot(lines: Iterable[Line], named: dict[str, Any]) -> Iterator[Line]:
    """Lines with the robot that all of them are for; one that makes no sense as it is."""
    for line in lines:
        if named:
            with contextlib.suppress(InvalidRequest):
                document = load_json(line.content)
                if isinstance(document, dict):
                    line = replace(line, content=json.dumps({**document, **named}).encode())
        yield line


def _report(output: BatchOutput, options: argparse.Namespace) -> int:
    count, verdicts = output.rows, output.verdicts
    failed = verdicts.total()
    if options.output is not None and not options.quiet:
        done = _RESULT[options.kind]
        say(f"{count - failed} of {count} requests {done}", f"wrote {options.output}")
    if failed:
        reasons = ", ".join(f"{n} {slug}" for slug, n in sorted(verdicts.items()))
        what = "no solution" if options.kind == "ik" else "no plan"
        sys.stderr.write(f"ikplan: {failed} of {count} requests have {what}: {reasons}\n")
        return NO_PLAN
    return 0
