"""Compile every kernel into one file, and check that plans need nothing else.

``python kernels/build.py FILE``: for any processor of the family, in as many processes as there are
processors; see README.md.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
CALL = """
import json, sys
from kernels_work import {function}
{function}({argument!r})
"""


def run(function: str, argument: object, environment: dict[str, str]) -> subprocess.Popen[str]:
    """Call a function of ``kernels_work`` in a process of its own."""
    environment = {**os.environ, **environment}
    places = [str(HERE), environment.get("PYTHONPATH", "")]
    environment["PYTHONPATH"] = os.pathsep.join(place for place in places if place)
    code = CALL.format(function=function, argument=argument)
    return subprocess.Popen(
        [sys.executable, "-P", "-c", code], env=environment, stderr=subprocess.PIPE, text=True
    )


def finish(processes: list[subprocess.Popen[str]]) -> str:
    """Wait for processes, and return what they say; one that fails ends this one."""
    said = [process.communicate()[1] for process in processes]
    if any(process.returncode for process in processes):
        sys.exit("".join(said))
    return "".join(said)


def main() -> None:
    """Compile, pack and check."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("file", type=Path, help="the file to write")
    parser.add_argument("--solvers", nargs="*", help="solvers; absent: all")
    parser.add_argument("--cache", help="a folder to keep what is compiled in, for the next time")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        cache = options.cache or folder
        shared = {"NUMBA_CPU_NAME": os.environ.get("NUMBA_CPU_NAME", "generic")}
        shared |= {"IKPLAN_COMPILE_AHEAD": "0", "OPENBLAS_NUM_THREADS": "1"}
        compiling = {**shared, "IKPLAN_KERNELS": "", "IKPLAN_CACHE_DIR": cache}
        begin = time.monotonic()
        count = len(os.sched_getaffinity(0))
        parts = [json.dumps([k, count, options.solvers]) for k in range(count)]
        finish([run("compile_part", part, compiling) for part in parts])
        took = time.monotonic() - begin
        pack = json.dumps([cache, str(options.file.resolve())])
        finish([run("pack", pack, compiling)])
        size = options.file.stat().st_size / 2**20
        print(f"{options.file}: {size:.1f} MiB, compiled in {took:.0f} s")
        nowhere = Path(folder) / "nowhere"
        nowhere.write_text("a file in place of a folder: nothing can be kept")
        alone = {**shared, "IKPLAN_KERNELS": str(options.file.resolve())}
        alone |= {"IKPLAN_CACHE_DIR": str(nowhere / "cache")}
        said = finish([run("check", part, alone) for part in parts])
    if "compiling" in said:
        sys.exit(f"kernels are missing from {options.file}:\n{said}")
    print("every example plans without compiling")


if __name__ == "__main__":
    main()
