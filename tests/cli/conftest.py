"""Commands in this process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pytest

from ikplan.cli import main


@dataclass(frozen=True)
class Done:
    """A command that ended.

    Attributes:
        code: Its exit code.
        out: What it wrote on standard output.
        err: What it wrote on stderr.
    """

    code: int
    out: str
    err: str


@pytest.fixture
def ask(capsysbinary: pytest.CaptureFixture[bytes]) -> Callable[..., Done]:
    """Run a command, whatever becomes of it."""

    def go(*arguments: object) -> Done:
        capsysbinary.readouterr()
        code = main([str(a) for a in arguments])
        output = capsysbinary.readouterr()
        return Done(code, output.out.decode(), output.err.decode())

    return go
