"""What is compiled for which command, and how long that takes: ``python -m benchmarks.compiling``.

Every kernel is compiled anew, into a folder that is thrown away: minutes of processor time. Time is
that of this process, of each function without those that it calls. With ``--demo`` it is what
``make demo`` compiles at its first run, with its helpers: the time of a first run and of a second.
"""

from __future__ import annotations

import argparse
import collections
import gc
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

_DEMO = Path(__file__).resolve().parents[1] / "examples" / "demo.py"


def main() -> None:
    """Print kernels, signatures and processor time of each kind of request, and duplicates."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--method", default="ik-ba", help="the solver")
    parser.add_argument("--kinds", nargs="+", default=["ik", "time", "plan"])
    parser.add_argument("--top", type=int, default=25, help="functions that are listed")
    parser.add_argument("--cache", help="a folder to keep the kernels in")
    parser.add_argument("--demo", action="store_true", help="time a first run of the demo instead")
    options = parser.parse_args()
    os.environ["IKPLAN_KERNELS"] = ""
    if options.demo:
        _time_demo()
        return
    os.environ["IKPLAN_COMPILE_AHEAD"] = "0"
    with tempfile.TemporaryDirectory() as folder:
        os.environ["IKPLAN_CACHE_DIR"] = options.cache or folder
        _measure(options)


def _time_demo() -> None:
    with tempfile.TemporaryDirectory() as folder:
        environment = {**os.environ, "IKPLAN_CACHE_DIR": str(Path(folder) / "cache")}
        times = []
        for run in ("first", "second"):
            before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
            subprocess.run(
                [sys.executable, str(_DEMO)],
                env=environment,
                cwd=folder,
                check=True,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
            )
            wall, after = time.monotonic() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
            spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
            times.append((wall, spent))
            print(f"{run} run: {wall:.1f} s wall, {spent:.1f} s of processors", flush=True)
    wall, spent = (first - second for first, second in zip(*times, strict=True))
    count = len(os.sched_getaffinity(0))
    print(f"compiling: {wall:.1f} s wall, {spent:.1f} s of processors, of which there are {count}")


def _measure(options: argparse.Namespace) -> None:
    from numba.core import event

    from ikplan.pipeline.plan import plan
    from ikplan.pipeline.poses import solve_ik_request
    from ikplan.pipeline.retime import time_request
    from ikplan.pipeline.warm_up import warm_up

    class Watch(event.Listener):  # type: ignore[misc]
        """Sums processor time by function and signature, each without what it calls."""

        def __init__(self) -> None:
            self.own: dict[tuple[str, str], float] = collections.defaultdict(float)
            self.stack: list[tuple[str, str]] = []
            self.last = 0.0

        def _pass(self) -> None:
            now = time.process_time()
            if self.stack:
                self.own[self.stack[-1]] += now - self.last
            self.last = now

        def on_start(self, event: Any) -> None:
            self._pass()
            function = event.data["dispatcher"].py_func
            name = f"{function.__module__}.{function.__qualname__}"
            self.stack.append((name, str(event.data["args"])))

        def on_end(self, event: Any) -> None:  # noqa: ARG002 - numba's interface
            self._pass()
            self.stack.pop()

    requests = {"ik": solve_ik_request, "time": time_request, "plan": plan}
    total: dict[tuple[str, str], float] = {}
    for kind in options.kinds:
        gc.collect()
        watch = Watch()
        begin, wall = time.process_time(), time.monotonic()
        with event.install_listener("numba:compile", watch):
            for jerk in (False, True) if kind != "ik" else (False,):
                warm_up(requests[kind], kind, options.method, jerk=jerk)
        took, waited = time.process_time() - begin, time.monotonic() - wall
        functions = len({name for name, _ in watch.own})
        print(
            f"{kind}: {len(watch.own)} signatures of {functions} functions, "
            f"{sum(watch.own.values()):.1f} s compiling of {took:.1f} s ({waited:.1f} s wall)"
        )
        total.update(watch.own)
    _report(total, options.top)


def _report(own: dict[tuple[str, str], float], top: int) -> None:
    rooms: dict[str, float] = collections.defaultdict(float)
    signatures: dict[str, list[float]] = collections.defaultdict(list)
    for (name, _), seconds in own.items():
        parts = name.split(".")
        rooms[".".join(parts[:2]) if parts[0] == "ikplan" else parts[0]] += seconds
        signatures[name].append(seconds)
    print("\nby room [s]")
    for room, seconds in sorted(rooms.items(), key=lambda item: -item[1]):
        print(f"  {seconds:6.1f}  {room}")
    print("\nby function [s]")
    for name, times in sorted(signatures.items(), key=lambda item: -sum(item[1]))[:top]:
        print(f"  {sum(times):6.2f}  {len(times)} x  {name}")
    print("\ncompiled more than once")
    for name, times in sorted(signatures.items(), key=lambda item: -sum(item[1])):
        if len(times) > 1 and name.startswith("ikplan"):
            print(f"  {sum(times):6.2f}  {len(times)} x  {name}")
            for (other, signature), seconds in own.items():
                if other == name:
                    print(f"          {seconds:5.2f}  {signature[:400]}")


if __name__ == "__main__":
    main()
