"""``ikplan completion``."""

from __future__ import annotations

import argparse
from collections.abc import Iterator

from ikplan.cli.parser import SHELLS
from ikplan.cli.terminal.output import say
from ikplan.errors import InvalidRequest

__all__ = ["completion"]

_FILES = ("FILE", "FOLDER")
"""What help calls an argument that is a file."""


def completion(options: argparse.Namespace) -> None:
    """Print the script by which a shell completes the command.

    Raises:
        InvalidRequest: No such shell.
    """
    if options.shell not in SHELLS:
        raise InvalidRequest(
            f"no completion for {options.shell!r}; there is one for {', '.join(SHELLS)}",
            field="SHELL",
            allowed=list(SHELLS),
        )
    import shtab

    parser = options.parser
    for action in _actions(parser):
        if action.metavar in _FILES:
            action.complete = shtab.FILE  # type: ignore[attr-defined]
    say(shtab.complete(parser, shell=options.shell))


def _actions(parser: argparse.ArgumentParser) -> Iterator[argparse.Action]:
    """Every argument of a parser and of those below it."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for below in dict.fromkeys(action.choices.values()):
                yield from _actions(below)
        else:
            yield action
