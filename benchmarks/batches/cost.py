"""Processor time a plan on Ray and on local workers: ``python -m benchmarks.batches.cost``.

``ikplan batch`` answers the same lines with ``--on local`` and ``--on ray``, by turns. Counted is
the processor time, of user and system, of the command and of every process below it or of its
session: the driver, the workers, and Ray's own processes, from the start of the command to its
end. Nothing is subtracted. With two numbers of lines the time a plan without the start is their
difference.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from statistics import median

from benchmarks.batches.requests import request_lines

_TICK = os.sysconf("SC_CLK_TCK")
_LOOK_S = 0.05


class _Counter:
    """Processor time of a session of processes, whoever waits for them."""

    def __init__(self, root: int) -> None:
        self._root = root
        self._known: set[int] = {root}
        self._seen: dict[tuple[int, int], float] = {}

    def look(self) -> None:
        """Note what every process has used so far."""
        stats = {}
        for file in Path("/proc").glob("[0-9]*/stat"):
            try:
                fields = file.read_text().rpartition(")")[2].split()
            except OSError:
                continue
            stats[int(file.parent.name)] = fields
        grown = True
        while grown:
            grown = False
            for process, fields in stats.items():
                mine = int(fields[1]) in self._known or int(fields[3]) == self._root
                if mine and process not in self._known:
                    self._known.add(process)
                    grown = True
        for process in self._known & set(stats):
            fields = stats[process]
            used = (int(fields[11]) + int(fields[12])) / _TICK
            self._seen[process, int(fields[19])] = used

    @property
    def seconds(self) -> float:
        """Processor time of all of them [s]."""
        return sum(self._seen.values())


def _seconds(on: str, file: Path, workers: int) -> float:
    """Processor time of one batch [s]."""
    with tempfile.TemporaryDirectory() as folder:
        command = [
            sys.executable, "-m", "ikplan", "batch", str(file), "-o", f"{folder}/out/", "--on", on,
            "--workers", str(workers), "-q",
        ]  # fmt: skip
        with subprocess.Popen(command, start_new_session=True) as process:
            counter = _Counter(process.pid)
            while process.poll() is None:
                counter.look()
                time.sleep(_LOOK_S)
            if process.returncode:
                raise RuntimeError(f"--on {on} ended with exit code {process.returncode}")
    return counter.seconds


def main() -> int:
    """Count, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--lines", type=int, nargs=2, default=[200, 1200], metavar=("FEW", "MANY"))
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--workers", type=int, default=1)
    options = parser.parse_args()
    few, many = options.lines
    found: dict[tuple[str, int], list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for count in (few, many):
            (Path(folder) / f"{count}.jsonl").write_bytes(b"".join(request_lines(count)))
        for _ in range(options.rounds):
            for count in (few, many):
                for on in ("local", "ray"):
                    seconds = _seconds(on, Path(folder) / f"{count}.jsonl", options.workers)
                    found.setdefault((on, count), []).append(seconds)
                    print(f"{on}, {count} lines: {seconds:.1f} s", flush=True)
    whole = {key: median(values) for key, values in found.items()}
    for count in (few, many):
        local, ray = whole["local", count], whole["ray", count]
        print(
            f"{count} plans, start included: local {1e3 * local / count:.1f} ms, ray "
            f"{1e3 * ray / count:.1f} ms a plan, ratio {ray / local:.3f}"
        )
    each = {on: 1e3 * (whole[on, many] - whole[on, few]) / (many - few) for on in ("local", "ray")}
    print(
        f"a further plan: local {each['local']:.1f} ms, ray {each['ray']:.1f} ms, ratio "
        f"{each['ray'] / each['local']:.3f}"
    )
    return 0


if __name__ == "__main__":
    sys.exit(main())
