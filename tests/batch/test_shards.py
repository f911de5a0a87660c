"""Shards: what is there is done, whatever ended the process before."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
import zstandard

from ikplan.errors import InvalidRequest
from tests.batch.echo_work import EchoWork, to_shards

COUNT = 120


def lines_of(count: int) -> list[bytes]:
    return [b'{"k": %d}' % k for k in range(count)]


def shards(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted(folder.glob("shard-*"))}


def rows(folder: Path) -> list[dict[str, object]]:
    decompressor = zstandard.ZstdDecompressor()
    return [
        json.loads(row)
        for data in shards(folder).values()
        for row in decompressor.decompress(data).splitlines()
    ]


def test_a_batch_killed_three_times_and_resumed_is_the_batch_that_was_not(tmp_path: Path) -> None:
    whole, broken, log = tmp_path / "whole", tmp_path / "broken", tmp_path / "log"
    log.mkdir()
    assert to_shards(whole, lines_of(COUNT), EchoWork(), "jsonl.zst", 8) == COUNT
    command = [sys.executable, "-m", "tests.batch.run_echo", str(broken), str(log), str(COUNT)]
    for kill in range(3):
        there = len(shards(broken))
        process = subprocess.Popen([*command, "local"])
        while len(shards(broken)) < there + 2:
            assert process.poll() is None, f"ended before kill {kill}"
            time.sleep(0.005)
        process.kill()
        assert process.wait() == -signal.SIGKILL
    done_before = 8 * len(shards(broken))
    assert subprocess.run([*command, "local"], check=False, timeout=60).returncode == 0
    assert shards(broken) == shards(whole)
    assert [row["index"] for row in rows(broken)] == list(range(COUNT))
    assert not list(broken.glob(".*"))
    # Only lines of shards that were not there are answered again: at most those under way, in
    # eight chunks of two lines and the shard being written.
    times = [len((log / str(k)).read_bytes()) for k in range(COUNT)]
    assert sum(times) - COUNT <= 3 * (8 * 2 + 2 * 2 + 8)
    assert done_before < COUNT


@pytest.mark.parametrize("form", ["jsonl.zst", "parquet"])
def test_a_shard_that_is_missing_is_made_again_with_the_same_bytes(
    form: str, tmp_path: Path
) -> None:
    if form == "parquet":
        pytest.importorskip("pyarrow")
    contents = lines_of(20)
    contents[3] = b'{"k": 3, "wrong": 1}'
    to_shards(tmp_path, contents, EchoWork(), form, 8)
    there = shards(tmp_path)
    assert [int(name[6:13]) for name in there] == [0, 1, 2]
    (tmp_path / f"shard-0000001.{form}").unlink()
    assert to_shards(tmp_path, contents, EchoWork(), form, 8) == 20
    assert shards(tmp_path) == there


def test_rows_of_parquet_have_index_status_and_either_plan_or_problem(tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    contents = [*lines_of(3), b'{"k": 3, "wrong": 1}']
    to_shards(tmp_path, contents, EchoWork(), "parquet", 8)
    table = parquet.read_table(tmp_path / "shard-0000000.parquet").to_pylist()
    assert [(r["index"], r["status"]) for r in table] == [(0, 200), (1, 200), (2, 200), (3, 422)]
    assert [r["plan"] for r in table] == ['{"k": 0}', '{"k": 1}', '{"k": 2}', None]
    assert json.loads(table[3]["problem"])["type"] == "urn:ikplan:invalid-request"
    assert table[0]["problem"] is None


def test_an_input_that_has_grown_is_continued_and_another_is_refused(tmp_path: Path) -> None:
    to_shards(tmp_path, lines_of(12), EchoWork(), "jsonl.zst", 8)
    first = shards(tmp_path)
    assert to_shards(tmp_path, lines_of(30), EchoWork(), "jsonl.zst", 8) == 30
    assert [row["index"] for row in rows(tmp_path)] == list(range(30))
    assert shards(tmp_path)["shard-0000000.jsonl.zst"] == first["shard-0000000.jsonl.zst"]
    other = [b'{"k": 99}', *lines_of(30)[1:]]
    with pytest.raises(InvalidRequest, match="answers other lines"):
        to_shards(tmp_path, other, EchoWork(), "jsonl.zst", 8)


def test_a_folder_takes_one_batch_by_one_process(tmp_path: Path) -> None:
    to_shards(tmp_path, lines_of(9), EchoWork(), "jsonl.zst", 8)
    with pytest.raises(InvalidRequest, match="begun with shard_lines 8, not 4"):
        to_shards(tmp_path, lines_of(9), EchoWork(), "jsonl.zst", 4)
    command = [sys.executable, "-c", "import fcntl, sys, time\nf = open(sys.argv[1], 'a')\n"
               "fcntl.flock(f, fcntl.LOCK_EX)\nprint(flush=True)\ntime.sleep(60)"]  # fmt: skip
    with subprocess.Popen([*command, tmp_path / "_batch.ndjson"], stdout=subprocess.PIPE) as other:
        assert other.stdout is not None
        other.stdout.readline()
        with pytest.raises(InvalidRequest, match="another process"):
            to_shards(tmp_path, lines_of(9), EchoWork(), "jsonl.zst", 8)
        os.kill(other.pid, signal.SIGKILL)
    assert to_shards(tmp_path, lines_of(9), EchoWork(), "jsonl.zst", 8) == 9
