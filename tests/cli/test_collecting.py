"""When a command looks for garbage."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ikplan.cli import main

END = (
    "import atexit, gc, sys\n"
    "from ikplan.cli import main\n"
    "def look():\n"
    "    print(gc.isenabled(), gc.get_freeze_count() > 1000, len(gc.get_objects()) < 1000)\n"
    "atexit.register(look)\n"
)


def at_the_end_of(*arguments: str) -> list[str]:
    """Whether the collector is on, much is set aside, and little is left for it to look at."""
    code = f"{END}sys.argv = {['ikplan', *arguments]!r}\nsys.exit(main())"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout.splitlines()[-1].split()


def test_a_brief_command_never_looks_for_garbage() -> None:
    assert at_the_end_of("fk", "ur5", *["0.1"] * 6) == ["False", "True", "True"]


def test_a_command_that_may_take_long_looks_for_it_and_ends_with_nothing_to_look_at() -> None:
    assert at_the_end_of("solvers") == ["True", "True", "True"]


@pytest.mark.parametrize("collects", [True, False])
def test_a_command_within_a_program_leaves_the_collector_to_it(
    collects: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    code = (
        f"import gc\nfrom ikplan.cli import main\n{'gc.enable()' if collects else 'gc.disable()'}\n"
        "frozen = gc.get_freeze_count()\n"
        "main(['fk', 'ur5', *['0.1'] * 6])\n"
        f"assert gc.isenabled() is {collects} and gc.get_freeze_count() == frozen\n"
    )
    subprocess.run([sys.executable, "-c", code], check=True, capture_output=True)
    assert main(["fk", "ur5", *["0.1"] * 6]) == 0
    assert "position" in capsys.readouterr().out
