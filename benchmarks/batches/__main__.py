"""A batch of plans killed and resumed: ``python -m benchmarks.batches --lines 20000 --kills 3``.

It prints the rate, the memory of the driver and of all processes (PSS) over each run, and whether
every line has exactly one row. With ``--compare`` the rows are held to an uninterrupted run, byte
for byte.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import zstandard

from benchmarks.batches.requests import request_lines


def _tree(root: int) -> Iterator[int]:
    """A process and all below it."""
    parents: dict[int, list[int]] = {}
    for file in Path("/proc").glob("[0-9]*/stat"):
        try:
            parent = int(file.read_text().rpartition(")")[2].split()[1])
        except OSError:
            continue
        parents.setdefault(parent, []).append(int(file.parent.name))
    pending = [root]
    while pending:
        process = pending.pop()
        yield process
        pending += parents.get(process, [])


def _pss(process: int) -> float:
    """Proportional memory of a process [MB]; 0: it has ended."""
    try:
        text = Path(f"/proc/{process}/smaps_rollup").read_text()
    except OSError:
        return 0.0
    return sum(int(row.split()[1]) for row in text.splitlines() if row.startswith("Pss:")) / 1024


def _shards(folder: Path) -> list[Path]:
    return sorted(folder.glob("shard-*.jsonl.zst"))


def _run(command: list[str], folder: Path, until: int) -> tuple[int, list[tuple[float, float]]]:
    """Run until there are so many shards, then kill it; its exit code and memory over time [MB]."""
    memory = []
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while process.poll() is None:
            memory.append((_pss(process.pid), sum(map(_pss, _tree(process.pid)))))
            if len(_shards(folder)) >= until:
                process.kill()
            time.sleep(2.0)
    return process.returncode, memory


def _indices(folder: Path) -> Iterator[int]:
    decompressor = zstandard.ZstdDecompressor()
    for shard in _shards(folder):
        for row in decompressor.decompress(shard.read_bytes()).splitlines():
            yield int(row[len(b'{"index": ') : row.index(b",")])


def _tell(name: str, memory: list[tuple[float, float]]) -> None:
    quarter = max(1, len(memory) // 4)
    parts = [memory[k : k + quarter] for k in range(0, len(memory), quarter)][:4]
    driver = ", ".join(f"{max(m[0] for m in part):.0f}" for part in parts)
    every = ", ".join(f"{max(m[1] for m in part):.0f}" for part in parts)
    print(f"{name}: memory by quarters, driver {driver} MB, all {every} MB", flush=True)


def main(arguments: list[str] | None = None) -> int:
    """Run the benchmark; 1 where a row is missing, there twice, or another."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.batches", description=__doc__)
    parser.add_argument("--lines", type=int, default=2000)
    parser.add_argument("--kills", type=int, default=3)
    parser.add_argument("--on", default="local")
    parser.add_argument("--compare", action="store_true")
    options = parser.parse_args(arguments)
    with tempfile.TemporaryDirectory() as scratch:
        requests, broken = Path(scratch) / "in.jsonl", Path(scratch) / "broken"
        requests.write_bytes(b"".join(request_lines(options.lines)))
        command = [sys.executable, "-m", "ikplan", "batch", str(requests), "--on", options.on, "-q"]
        total = -(-options.lines // 128)
        begun = time.perf_counter()
        for run in range(options.kills + 1):
            until = total * (run + 1) // (options.kills + 1) if run < options.kills else total + 1
            code, memory = _run([*command, "--resume", "-o", f"{broken}/"], broken, until)
            print(f"run {run}: exit code {code}, {len(_shards(broken))} of {total} shards")
            _tell(f"run {run}", memory)
        rate = options.lines / (time.perf_counter() - begun)
        once = list(_indices(broken)) == list(range(options.lines))
        print(json.dumps({"lines": options.lines, "exactly_once": once, "lines_per_s": rate}))
        same = True
        if options.compare:
            whole = Path(scratch) / "whole"
            _, memory = _run([*command, "-o", f"{whole}/"], whole, total + 1)
            _tell("uninterrupted", memory)
            same = all((broken / s.name).read_bytes() == s.read_bytes() for s in _shards(whole))
            print("the bytes are", "the same" if same else "others")
    return 0 if once and same else 1


if __name__ == "__main__":
    sys.exit(main())
