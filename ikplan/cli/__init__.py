"""The ``ikplan`` command."""

from __future__ import annotations

import os
import signal
import sys
from collections.abc import Sequence

from ikplan.cli.parser import make_parser, numbers_as_values
from ikplan.errors import IkplanError

__all__ = ["main"]


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command.

    Args:
        argv: The arguments; None: those of the process.

    Returns:
        The exit code: 0, or 2 with one line on stderr saying what is wrong and what to do; 1 for a
        batch of which not every request has a plan.
    """
    arguments = numbers_as_values(sys.argv[1:] if argv is None else argv)
    try:
        options = make_parser().parse_args(arguments)
        code = options.run(options)
        sys.stdout.flush()
    except IkplanError as error:
        return _fail(error.slug, error.detail)
    except BrokenPipeError:
        # Whoever read the output has seen enough; nothing may be flushed there at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except OSError as error:
        reason = error.strerror or str(error)
        where = f"{error.filename}: " if error.filename is not None else ""
        return _fail("file-error", f"{where}{reason}")
    except KeyboardInterrupt:
        return 128 + signal.SIGINT
    return code or 0


def _fail(slug: str, detail: str) -> int:
    words = " ".join(detail.split())
    plain = "".join(c if c.isprintable() else "?" for c in words)
    line = f"ikplan: {slug}: {plain}\n"
    encoding = sys.stderr.encoding or "utf-8"
    sys.stderr.write(line.encode(encoding, "backslashreplace").decode(encoding))
    return 2
