"""Many requests in the shell: JSON lines in, JSON lines out, by processes of their own."""

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import zstandard

import ikplan
from ikplan.cli import main
from tests.two_joints import URDF

from .conftest import Done

REQUEST = {"robot": "ur5", "sampling": {"rate_hz": 50}}
GOOD = [
    {**REQUEST, "path": {"waypoints": [{"position": [0.4, y, 0.4]}]}} for y in (-0.1, 0.0, 0.1, 0.2)
]
FAR = {**REQUEST, "path": {"waypoints": [{"position": [9.0, 0.0, 0.0]}]}}
KILLING = """
import json, multiprocessing.forkserver, os, signal, sys, threading, time
from pathlib import Path
from ikplan.batch.chunks import Chunk, Line
from ikplan.batch.local import LocalExecutor
from ikplan.batch.requests import RequestWork

def kill_the_worker():
    keeper = multiprocessing.forkserver._forkserver._forkserver_pid
    while True:
        time.sleep(0.5)
        for stat in Path("/proc").glob("[0-9]*/stat"):
            try:
                words = stat.read_text().rpartition(")")[2].split()
            except OSError:
                continue
            if int(words[1]) == keeper:
                os.kill(int(stat.parent.name), signal.SIGKILL)
                print(time.monotonic(), flush=True)
                return

if __name__ == "__main__":
    lines = json.loads(sys.argv[1])
    chunks = (Chunk((Line(k, line.encode(), 0),)) for k, line in enumerate(lines))
    answers = LocalExecutor(RequestWork("plan"), 1).run(chunks)
    statuses = [next(answers).outcomes[0].status]
    killing = threading.Thread(target=kill_the_worker)
    killing.start()
    statuses.append(next(answers).outcomes[0].status)
    print(time.monotonic(), flush=True)
    killing.join()
    print(json.dumps(statuses + [done.outcomes[0].status for done in answers]))
"""


@pytest.fixture
def run(ask: Callable[..., Done], monkeypatch: pytest.MonkeyPatch) -> Callable[..., Done]:
    """Run a command, whatever becomes of it, with bytes on its standard input."""

    def go(*arguments: object, given: bytes = b"") -> Done:
        reading, writing = os.pipe()
        os.write(writing, given)
        os.close(writing)
        with open(reading) as piped:
            monkeypatch.setattr("sys.stdin", piped)
            return ask(*arguments)

    return go


def json_lines(*requests: object) -> bytes:
    return b"\n".join(json.dumps(r).encode() for r in requests)


def test_every_line_is_answered_in_its_place_and_none_spoils_another(
    run: Callable[..., Done],
) -> None:
    body = json_lines(GOOD[0], FAR) + b"\n\n  \n{not JSON\r\n" + json_lines(*GOOD[1:], [1])
    done = run("batch", "-", "--workers", "2", given=body)
    assert done.code == 1
    told = [json.loads(line) for line in done.out.splitlines()]
    assert [t["index"] for t in told] == list(range(7))
    assert [t["status"] for t in told] == [200, 422, 422, 200, 200, 200, 422]
    assert [t["problem"]["type"] for t in told if "problem" in t] == [
        "urn:ikplan:unreachable",
        "urn:ikplan:invalid-request",
        "urn:ikplan:invalid-request",
    ]
    for request, answer in zip(GOOD, (told[k] for k in (0, 3, 4, 5)), strict=True):
        alone = ikplan.plan(request).model_dump(mode="json")
        assert {**answer["plan"], "stats": None} == {**alone, "stats": None}
    said = done.err.splitlines()
    # A first use tells that it compiles, and a slow one how far it has got.
    said = [line for line in said if not line.startswith("compiling") and "lines/s" not in line]
    assert said == ["ikplan: 3 of 7 requests have no plan: 2 invalid-request, 1 unreachable"]


def test_a_batch_for_the_robot_of_a_file(run: Callable[..., Done], tmp_path: Path) -> None:
    urdf, requests, out = (tmp_path / name for name in ("two.urdf", "in.jsonl", "out.jsonl"))
    urdf.write_text(URDF)
    document = {"start": [0.0, 0.1], "path": {"waypoints": [{"position": [0.4, 0.2, 0.0]}]}}
    requests.write_bytes(json_lines({"robot": "any", **document}, document))
    options = ["--robot", urdf, "--base", "base", "--tip", "tip", "-o", out, "--workers", "1"]
    done = run("batch", requests, *options)
    assert done.code == 0, done.err
    assert done.out.splitlines() == ["2 of 2 requests planned", f"wrote {out}"]
    for line in out.read_bytes().splitlines():
        plan = ikplan.Plan.load(json.dumps(json.loads(line)["plan"]))
        assert plan.robot == "two"
        assert np.allclose(
            plan.waypoints.q[-1], [np.arctan2(0.2, 0.4), np.hypot(0.4, 0.2) - 0.3], atol=1e-6
        )


def test_a_worker_that_is_killed_from_outside_costs_no_line() -> None:
    waypoints = [{"position": [0.4, 0.01 * i, 0.4]} for i in range(50)]
    search = {"population": 400, "iterations": 400}
    slow = {**REQUEST, "path": {"waypoints": waypoints}, "ik": search, "budget_s": 100}
    lines = [json.dumps(r) for r in (GOOD[0], slow, *GOOD[1:])]
    command = [sys.executable, "-c", KILLING, json.dumps(lines)]
    done = subprocess.run(command, capture_output=True, timeout=100, check=False)
    assert done.returncode == 0, done.stderr
    killed, finished, statuses = done.stdout.splitlines()
    assert float(killed) < float(finished), "the line was over before the worker was killed"
    assert json.loads(statuses) == [200] * len(lines)


def test_a_batch_in_shards_that_is_killed_is_resumed_to_the_same_bytes(
    run: Callable[..., Done], tmp_path: Path
) -> None:
    requests, whole, broken = tmp_path / "in.jsonl", tmp_path / "whole", tmp_path / "broken"
    waypoints = [{"position": [0.4, -0.2 + 0.02 * k, 0.4]} for k in range(20)]
    asked = [{**REQUEST, "path": {"waypoints": [w]}} for w in waypoints]
    requests.write_bytes(json_lines(*asked, FAR))
    options = ["batch", requests, "--shard-lines", "4", "--workers", "2", "-o"]
    assert run(*options, f"{whole}/").code == 1
    command = [sys.executable, "-m", "ikplan", *map(str, options), f"{broken}/"]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL) as process:
        while len(list(broken.glob("shard-*"))) < 2:
            assert process.poll() is None
            time.sleep(0.005)
        process.kill()
    left = {file.name for file in broken.glob("shard-*")}
    refused = run(*options, f"{broken}/")
    assert refused.code == 2
    assert "--resume continues it" in refused.err
    assert {file.name for file in broken.glob("shard-*")} == left
    done = run(*options, f"{broken}/", "--resume")
    assert done.code == 1
    assert done.out.splitlines()[0] == "20 of 21 requests planned"
    assert done.err == "ikplan: 1 of 21 requests have no plan: 1 unreachable\n"
    shards = sorted(whole.glob("shard-*"))
    assert len(shards) == 6
    for shard in shards:
        assert (broken / shard.name).read_bytes() == shard.read_bytes()
    rows = b"".join(zstandard.ZstdDecompressor().decompress(s.read_bytes()) for s in shards)
    told = [json.loads(row) for row in rows.splitlines()]
    assert [row["index"] for row in told] == list(range(21))
    assert [row["status"] for row in told] == [200] * 20 + [422]
    assert ikplan.Plan.load(json.dumps(told[7]["plan"])).q[-1] == pytest.approx(
        ikplan.plan(asked[7]).q[-1], abs=0.0
    )


def test_moves_timings_and_poses_are_answered_like_plans(run: Callable[..., Done]) -> None:
    move = {"robot": "ur5", "start": [0, -1.5, 1.5, 0, 1, 0], "goal": [0.5, -1.2, 1.2, 0, 1, 0]}
    wrong = {"robot": "ur5", "goals": []}
    timing = {"robot": "ur5", "waypoints": [move["start"], move["goal"]]}
    pose = {"robot": "ur5", "position": [0.4, 0.1, 0.4]}
    for kind, requests in {
        "move": [move, wrong],
        "time": [timing, wrong],
        "ik": [pose, wrong],
    }.items():
        done = run("batch", "-", "--kind", kind, "--workers", "1", given=json_lines(*requests))
        assert done.code == 1, done.err
        good, bad = (json.loads(row) for row in done.out.splitlines())
        assert bad["problem"]["type"] == "urn:ikplan:invalid-request"
        if kind == "ik":
            assert (
                good["plan"]["q"]
                == ikplan.solve_ik(ikplan.load_robot("ur5"), np.array(pose["position"])).q.tolist()
            )
        else:
            assert ikplan.Plan.load(json.dumps(good["plan"])).q[-1] == pytest.approx(move["goal"])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["/no/such.jsonl"], "/no/such.jsonl: No such file"),
        ([os.devnull], "at least one line"),
        (["requests.jsonl", "--workers", "-1"], "--workers"),
        (["requests.jsonl", "--tip", "tool0"], "--robot"),
        (["requests.jsonl", "-o", "/no/such/folder/plans.jsonl"], "/no/such/folder"),
        (["requests.jsonl", "--server", "http://127.0.0.1:1"], "cannot reach"),
        (["requests.jsonl", "--kind", "fk"], "plan, move, time, ik"),
        (["requests.jsonl", "--on", "dask"], "local, ray or ray=ADDRESS"),
        (["requests.jsonl", "--resume"], "-o"),
        (["requests.jsonl", "-o", "rows.jsonl", "--format", "parquet"], "belongs to a folder"),
        (["requests.jsonl", "-o", "rows/", "--format", "csv"], "jsonl.zst"),
        (["requests.jsonl", "-o", "rows/", "--shard-lines", "0"], "1 or more"),
    ],
)
def test_a_batch_that_cannot_be_done_is_one_line_that_helps(
    arguments: list[str],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("requests.jsonl").write_bytes(json_lines(*GOOD))
    assert main(["batch", *arguments]) == (3 if "--server" in arguments else 2)
    output = capsys.readouterr()
    assert output.out == ""
    (line,) = output.err.splitlines()
    assert line.startswith("ikplan: ")
    assert words in line
