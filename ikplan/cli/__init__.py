"""The ``ikplan`` command."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence

from ikplan.cli.parser import as_one_command, make_parser, numbers_as_values
from ikplan.cli.requests.service import choose_service
from ikplan.cli.terminal import collecting
from ikplan.cli.terminal.failing import fail, fail_of_fault, fail_of_file
from ikplan.errors import IkplanError

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        argv: The arguments; None: those of the process.

    Returns:
        The exit code: 0; 1: there is no plan, or not for every request of a batch; 2: wrong usage
        or input; 3: the service cannot be reached or refuses, or a fault of ours. What is wrong and
        what to do is one line on stderr; with ``--json``, the problem document on stdout too.
    """
    if argv is not None:
        return _run(argv)
    collecting.start()
    try:
        return _run(sys.argv[1:])
    finally:
        collecting.end()


def _run(argv: Sequence[str]) -> int:
    typed = as_one_command(list(argv))
    arguments = numbers_as_values(typed)
    as_json = "--json" in arguments
    try:
        options = make_parser().parse_args(arguments)
        choose_service(options)
        code = options.run(options)
        sys.stdout.flush()
    except IkplanError as error:
        return fail(error, as_json=as_json)
    except BrokenPipeError:
        # Whoever read the output has seen enough; nothing may be flushed there at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except OSError as error:
        return fail_of_file(error, as_json=as_json)
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    except Exception as error:  # the outermost frame: told in full, with its own exit code
        return fail_of_fault(error, as_json=as_json)
    return code or 0
