"""``python -m benchmarks.fuzz``: fuzz every reader, each in a process of its own (``make fuzz``).

A fault is anything but an error of the library, more than 2 s of processor time, more memory than
allowed, or the end of the process. Its document is put into ``out/fuzz``.
"""

from __future__ import annotations

import argparse
import json
import resource
import signal
import subprocess
import sys
from pathlib import Path

from benchmarks.fuzz.run import Report, fuzz
from benchmarks.fuzz.targets import TARGETS

_MEMORY_BYTES = 2 * 2**30
"""Private memory of a process that reads [bytes], as of a worker."""
_MOST_GROWTH = 768 * 2**20
"""Most that the documents may add to it [bytes]."""


def main() -> int:
    """Fuzz; return the exit code: 0 where nothing was found."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz", description=__doc__)
    parser.add_argument("targets", nargs="*", help=f"default: all of {', '.join(TARGETS)}")
    parser.add_argument("--minutes", type=float, default=30.0, help="time in all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    parser.add_argument("--child", type=float, help=argparse.SUPPRESS)
    options = parser.parse_args()
    names: list[str] = options.targets or list(TARGETS)
    if unknown := set(names) - set(TARGETS):
        parser.error(f"unknown: {', '.join(sorted(unknown))}")
    options.out.mkdir(parents=True, exist_ok=True)
    if options.child is not None:
        _read(names[0], options.seed, options.child, options.out)
        return 0
    seconds = 60.0 * options.minutes / len(names)
    found = [_fuzz(name, options.seed, seconds, options.out) for name in names]
    return int(any(found))


def _read(name: str, first_seed: int, seconds: float, out: Path) -> None:
    """Fuzz one target in this process, and print the report as JSON."""
    resource.setrlimit(resource.RLIMIT_DATA, (_MEMORY_BYTES, _MEMORY_BYTES))
    with (out / f"{name}-last").open("wb") as last:

        def watch(document: bytes) -> None:
            last.seek(0)
            last.write(document)
            last.truncate()
            last.flush()

        report = fuzz(name, first_seed=first_seed, seconds=seconds, watch=watch, faults=out)
    print(json.dumps(report._asdict()))


def _fuzz(name: str, first_seed: int, seconds: float, out: Path) -> bool:
    """Fuzz one target in a process of its own; return whether anything was found."""
    command = [sys.executable, "-m", "benchmarks.fuzz", name, "--child", str(seconds)]
    command += ["--seed", str(first_seed), "--out", str(out)]
    done = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        code = done.returncode
        how = signal.Signals(-code).name if code < 0 else f"exit code {code}"
        print(f"{name}: the process ended by {how}; its document is {out / name}-last", flush=True)
        return True
    report = Report(**json.loads(done.stdout.splitlines()[-1]))
    (out / f"{name}-last").unlink()
    print(
        f"{name}: {report.read} documents read, {report.refused} refused; slowest "
        f"{report.slowest_s:.2f} s; memory grew by {report.growth_bytes / 2**20:.0f} MiB; "
        f"{len(report.faults)} faults",
        flush=True,
    )
    for fault in report.faults:
        print(fault, flush=True)
    if report.growth_bytes > _MOST_GROWTH:
        print(f"{name}: more than {_MOST_GROWTH / 2**20:.0f} MiB", flush=True)
    return bool(report.faults) or report.growth_bytes > _MOST_GROWTH


if __name__ == "__main__":
    raise SystemExit(main())
