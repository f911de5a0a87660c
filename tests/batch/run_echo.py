"""Answer numbered lines into a folder, as a process that a test can kill."""

import sys
from pathlib import Path

from tests.batch.echo_work import EchoWork, to_shards

if __name__ == "__main__":
    folder, log, count, on = sys.argv[1:]
    lines = [b'{"k": %d}' % k for k in range(int(count))]
    to_shards(Path(folder), lines, EchoWork(log, 0.02), "jsonl.zst", 8, on)
