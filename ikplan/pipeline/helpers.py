"""Processes that compile kernels beside the one that waits for them."""

from __future__ import annotations

import atexit
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from ikplan._jit import when_compiling
from ikplan.limits.motion_limits import MotionLimits

__all__ = ["VARIABLE", "helped_by"]

VARIABLE = "IKPLAN_COMPILE_AHEAD"
"""``0`` in the environment: no such processes."""
_MODULE = "ikplan.pipeline.compile_ahead"
_MOST = 3

_arguments: list[str] = []
_helpers: list[subprocess.Popen[bytes]] = []


def helped_by(kind: str, method: str = "ik-ba", limits: Sequence[MotionLimits] = ()) -> None:
    """Say what helpers are to compile, should this process have to compile something.

    Args:
        kind: Which requests follow: ik, time or plan.
        method: Name of their solver.
        limits: Their limits, which decide what timing is compiled.
    """
    if not _arguments:
        _listen(_start)
    jerk = any(each.jerk is not None for each in limits)
    loads = any(each.of_loads_or_tool for each in limits)
    _arguments[:] = [kind, method, str(int(jerk)), str(int(loads))]


def _listen(start: Callable[[], None]) -> None:
    if os.environ.get(VARIABLE, "1") != "0" and "python" in Path(sys.executable or "").name:
        when_compiling(start)


def _start() -> None:
    """Start a helper for every processor but this process's own."""
    count = min(len(os.sched_getaffinity(0)) - 1, _MOST)
    environment = {**os.environ, VARIABLE: "0"}
    environment["PYTHONPATH"] = os.pathsep.join(path for path in sys.path if path)
    for number in range(count):
        command = [sys.executable, "-P", "-m", _MODULE, *_arguments, str(number), str(count)]
        try:
            _helpers.append(
                subprocess.Popen(
                    command,
                    stdin=subprocess.DEVNULL,
                    stdout=subprocess.DEVNULL,
                    stderr=subprocess.DEVNULL,
                    env=environment,
                )
            )
        except OSError:
            return  # it takes longer without help
    atexit.register(_stop)


def _stop() -> None:
    """End the helpers: what they have compiled is kept, and nobody waits for the rest."""
    for helper in _helpers:
        helper.terminate()
        helper.wait()
    _helpers.clear()
