"""``python -m benchmarks.service [overhead] [load] [overload] [faults] [soak]``."""

from __future__ import annotations

import argparse
import functools
import os
import tempfile
from collections.abc import Callable, Iterable
from pathlib import Path

from benchmarks.service.faults import try_faults
from benchmarks.service.load import measure_load, measure_overload
from benchmarks.service.overhead import measure_overhead
from benchmarks.service.soak import soak

_STUDIES: dict[str, Callable[[], Iterable[str]]] = {
    "overhead": measure_overhead,
    "load": measure_load,
    "overload": measure_overload,
    "faults": try_faults,
    "soak": soak,
}


def main() -> None:
    """Run the studies named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("studies", nargs="*", choices=[*_STUDIES, []], help="default: all")
    parser.add_argument("--requests", type=int, default=20_000, help="of the soak")
    parser.add_argument("--seconds", type=float, default=1200.0, help="longest time of the soak")
    options = parser.parse_args()
    _STUDIES["soak"] = functools.partial(soak, options.requests, options.seconds)
    studies = options.studies or list(_STUDIES)
    with tempfile.TemporaryDirectory() as folder:
        os.environ["IKPLAN_STORE_PATH"] = str(Path(folder) / "store.sqlite3")
        for name in studies:
            print(f"{name}:", flush=True)
            for line in _STUDIES[name]():
                print(f"  {line}", flush=True)


if __name__ == "__main__":
    main()
