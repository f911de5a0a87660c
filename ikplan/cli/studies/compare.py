"""``ikplan compare``."""

from __future__ import annotations

import argparse
import json
import math
import runpy
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ikplan.cli.requests.robot import named_or_loaded
from ikplan.cli.requests.scene import set_scene
from ikplan.cli.terminal.output import say, say_json
from ikplan.cli.terminal.progress import progress_bar
from ikplan.cli.terminal.telling import tell_start
from ikplan.errors import InvalidRequest

__all__ = ["compare"]


def compare(options: argparse.Namespace) -> None:
    """Compare solvers.

    Raises:
        InvalidRequest: An option makes no sense.
        RobotNotFound: No robot of that name.
        OSError: A file cannot be read or written.
    """
    tell_start(options, "loading")
    from ikplan.arena.compare import compare as compare_solvers

    for file in options.module:
        _register(Path(file))
    robot = named_or_loaded(options, options.robot)
    document: dict[str, Any] = {"scene": {} if options.self_collision else None}
    set_scene(options, document)
    distance = None if options.start_distance is None else math.radians(options.start_distance)
    with progress_bar(quiet=options.quiet) as bar:
        found = compare_solvers(
            [_entrant(given) for given in options.solvers],
            robot,
            options.targets,
            range(options.first_seed, options.first_seed + options.seeds),
            options.budget,
            kind=options.kind,
            start_distance=distance,
            scene=document["scene"],
            params=_parameters(options.param, "--param"),
            population=options.population,
            progress=None if bar is None else lambda done, count: bar("runs", done, count),
        )
    written = [] if options.output is None else found.save(options.output)
    if options.json:
        say_json({"summary": found.summary(), "rows": found.rows()})
        return
    say(found.table().rstrip("\n"), *(f"wrote {file}" for file in written))


def _register(file: Path) -> None:
    """Run a file that registers solvers.

    Raises:
        InvalidRequest: There is none, or it ended with an error.
    """
    if not file.is_file():
        raise InvalidRequest(f"--module: there is no file {file}", field="--module")
    try:
        names = runpy.run_path(str(file), run_name="ikplan_solvers")
        register = names.get("register")
        if callable(register):
            register()
    except Exception as error:  # whatever the file raises
        raise InvalidRequest(
            f"--module: {file} ended with {type(error).__name__}: {error}", field="--module"
        ) from error


def _entrant(given: str) -> tuple[str, dict[str, Any]]:
    """Return a solver with parameters of its own: ``name`` or ``name:key=value,...``."""
    method, _, own = given.partition(":")
    return given, {"method": method, **_parameters([p for p in own.split(",") if p], given)}


def _parameters(given: Sequence[str], what: str) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for pair in given:
        name, equals, value = pair.partition("=")
        if not equals or not name:
            raise InvalidRequest(
                f"{what}: must be NAME=VALUE, not {pair!r}", field=what, allowed="NAME=VALUE"
            )
        try:
            found[name] = json.loads(value)
        except ValueError:
            found[name] = value
    return found
