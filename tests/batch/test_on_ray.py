"""Batches on a real Ray cluster of this machine: the rows are those of local workers."""

import importlib.util
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from ikplan.batch.local import LocalExecutor
from ikplan.batch.on_ray import RayExecutor
from tests.batch.echo_work import EchoWork, answers_of, to_shards

pytestmark = [
    pytest.mark.skipif(
        importlib.util.find_spec("ray") is None,
        reason="Ray is not installed: pip install 'ikplan[ray]'",
    ),
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning"),
]

LINES = [b'{"k": %d}' % k for k in range(40)]
LINES[7] = b'{"k": 7, "kill": 9}'
LINES[13] = b'{"k": 13, "wrong": 1}'


def actors() -> Iterator[int]:
    """Processes of actors of this user."""
    for stat in Path("/proc").glob("[0-9]*/cmdline"):
        try:
            command = stat.read_bytes()
        except OSError:
            continue
        if command.startswith(b"ray::_Actor"):
            yield int(stat.parent.name)


def test_rows_are_those_of_local_workers_also_where_an_actor_is_killed() -> None:
    local = answers_of(LocalExecutor(EchoWork(), 2), LINES, 4)
    assert local[7].slug == "worker-lost"
    before = set(actors())
    executor = RayExecutor(EchoWork(seconds=0.1), 2)
    killed = []

    def kill_one() -> None:
        while not (new := set(actors()) - before):
            time.sleep(0.05)
        time.sleep(1.5)
        killed.append(min(new))
        os.kill(killed[0], signal.SIGKILL)

    killing = threading.Thread(target=kill_one)
    killing.start()
    try:
        assert answers_of(executor, LINES, 4) == local
    finally:
        executor.close()
    killing.join()
    assert killed


def test_a_driver_that_is_killed_leaves_no_actor_and_is_resumed_to_the_same_bytes(
    tmp_path: Path,
) -> None:
    whole, broken, log = tmp_path / "whole", tmp_path / "broken", tmp_path / "log"
    log.mkdir()
    lines = [b'{"k": %d}' % k for k in range(100)]
    to_shards(whole, lines, EchoWork(), "jsonl.zst", 8)
    before = set(actors())
    command = [sys.executable, "-m", "tests.batch.run_echo", str(broken), str(log), "100"]
    with subprocess.Popen([*command, "ray"], stderr=subprocess.DEVNULL) as driver:
        while len(list(broken.glob("shard-*"))) < 2:
            assert driver.poll() is None
            time.sleep(0.01)
        driver.kill()
    deadline = time.monotonic() + 60.0
    while set(actors()) - before:
        assert time.monotonic() < deadline
        time.sleep(0.1)
    assert len(list(broken.glob("shard-*"))) < 13
    subprocess.run([*command, "local"], check=True, timeout=60)
    names = sorted(file.name for file in whole.glob("shard-*"))
    assert sorted(file.name for file in broken.glob("shard-*")) == names
    assert all((broken / n).read_bytes() == (whole / n).read_bytes() for n in names)


def test_the_cluster_listens_on_loopback_only() -> None:
    executor = RayExecutor(EchoWork(), 1)
    import ray  # after the executor, which decides how it listens

    try:
        answers_of(executor, LINES[:1], 1)
        assert {node["NodeManagerAddress"] for node in ray.nodes()} == {"127.0.0.1"}
    finally:
        executor.close()
