"""Ask a running service everything that its OpenAPI document allows, and much that it does not.

``python -m benchmarks.contract`` starts a service on a free loopback port, lets schemathesis
generate requests for every operation, by example, by boundary value, at random, and in sequences
that follow what is answered, and checks that no answer is a 5xx and that each one is as documented.
The report goes to ``out/contract``.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from benchmarks.contract.hooks import EXCLUDED

_SERVICE = [sys.executable, "-m", "ikplan", "serve", "--port", "0"]
_CONFIG = Path(__file__).with_name("schemathesis.toml")
_SETTINGS = {
    "IKPLAN_STORE_PATH": ":memory:",
    # What is asked at random has mostly no good answer: it should not take long to say so.
    "IKPLAN_MAX_BUDGET_S": "1",
    "IKPLAN_LOG_FORMAT": "json",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run it; return the exit code: 0 where nothing was found."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.contract", description=__doc__)
    parser.add_argument(
        "--examples",
        type=int,
        default=200,
        help="examples of each operation; 180 make about 10,000 requests",
    )
    parser.add_argument("--minutes", type=float, default=60.0, help="longest time")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--phases", default="examples,coverage,fuzzing,stateful")
    parser.add_argument("--out", type=Path, default=Path("out/contract"))
    options = parser.parse_args(argv)
    options.out.mkdir(parents=True, exist_ok=True)
    with (
        (options.out / "service.log").open("w") as log,
        subprocess.Popen(
            _SERVICE, stderr=subprocess.PIPE, text=True, env={**os.environ, **_SETTINGS}
        ) as service,
    ):
        try:
            assert service.stderr is not None
            address = _address(service.stderr.readline())
            with subprocess.Popen(["cat"], stdin=service.stderr, stdout=log) as logging:
                code = _ask(address, options)
                service.terminate()
                logging.wait()
        finally:
            service.kill()
    faults = [line for line in (options.out / "service.log").open() if '"ERROR"' in line]
    print(f"{len(faults)} errors in the service's log")
    return code or int(bool(faults))


def _address(line: str) -> str:
    found = re.search(r"http://\S+", line)
    if found is None:
        raise SystemExit(f"the service did not start: {line}")
    return found[0]


def _ask(address: str, options: argparse.Namespace) -> int:
    command = [
        *(sys.executable, "-m", "schemathesis.cli", "--config-file", str(_CONFIG)),
        *("run", f"{address}/openapi.json"),
        *("--exclude-checks", ",".join(EXCLUDED), "--phases", options.phases),
        *("--max-examples", str(options.examples), "--max-time", str(round(60 * options.minutes))),
        *("--seed", str(options.seed), "--request-timeout", "60", "--continue-on-failure"),
        *("--generation-database", "none", "--no-color"),
        *("--report", "junit", "--report-dir", str(options.out)),
    ]
    environment = {**os.environ, "SCHEMATHESIS_HOOKS": "benchmarks.contract.hooks"}
    return subprocess.run(command, env=environment, check=False).returncode


if __name__ == "__main__":
    raise SystemExit(main())
