"""Many requests in the shell: JSON lines in, JSON lines out, by processes of their own."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import ikplan
from ikplan.cli import main
from tests.two_joints import URDF

REQUEST = {"robot": "ur5", "sampling": {"rate_hz": 50}}
GOOD = [
    {**REQUEST, "path": {"waypoints": [{"position": [0.4, y, 0.4]}]}} for y in (-0.1, 0.0, 0.1, 0.2)
]
FAR = {**REQUEST, "path": {"waypoints": [{"position": [9.0, 0.0, 0.0]}]}}
KILLING = """
import json, multiprocessing.forkserver, os, signal, sys, threading, time
from pathlib import Path
from ikplan.workers import plan_lines

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
                return

if __name__ == "__main__":
    answers = plan_lines([line.encode() for line in json.loads(sys.argv[1])], workers=1)
    told = [next(answers)]
    threading.Thread(target=kill_the_worker, daemon=True).start()
    told += answers
    print(json.dumps([a.to_problem() if not isinstance(a, bytes) else len(a) for a in told]))
"""


def run(*arguments: object, given: bytes | None = None) -> subprocess.CompletedProcess[bytes]:
    command = [sys.executable, "-m", "ikplan", *map(str, arguments)]
    return subprocess.run(command, input=given, capture_output=True, timeout=200, check=False)


def json_lines(*requests: object) -> bytes:
    return b"\n".join(json.dumps(r).encode() for r in requests)


def test_every_line_is_answered_in_its_place_and_none_spoils_another():
    body = json_lines(GOOD[0], FAR) + b"\n\n  \n{not JSON\r\n" + json_lines(*GOOD[1:], [1])
    done = run("batch", "-", "--workers", "2", given=body)
    assert done.returncode == 1
    told = [json.loads(line) for line in done.stdout.splitlines()]
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
    said = done.stderr.decode().splitlines()
    said = [line for line in said if not line.startswith("compiling kernels")]  # a first use
    assert said == ["ikplan: 3 of 7 requests have no plan: 2 invalid-request, 1 unreachable"]


def test_a_batch_for_the_robot_of_a_file(tmp_path):
    urdf, requests, out = (tmp_path / name for name in ("two.urdf", "in.jsonl", "out.jsonl"))
    urdf.write_text(URDF)
    document = {"start": [0.0, 0.1], "path": {"waypoints": [{"position": [0.4, 0.2, 0.0]}]}}
    requests.write_bytes(json_lines({"robot": "any", **document}, document))
    options = ["--robot", urdf, "--base", "base", "--tip", "tip", "-o", out, "--workers", "1"]
    done = run("batch", requests, *options)
    assert done.returncode == 0, done.stderr
    assert done.stdout.decode().splitlines() == ["2 of 2 requests planned", f"wrote {out}"]
    for line in out.read_bytes().splitlines():
        plan = ikplan.Plan.load(json.dumps(json.loads(line)["plan"]))
        assert plan.robot == "two"
        assert np.allclose(
            plan.waypoints.q[-1], [np.arctan2(0.2, 0.4), np.hypot(0.4, 0.2) - 0.3], atol=1e-6
        )


def test_a_process_that_is_killed_costs_its_own_line_only():
    waypoints = [{"position": [0.4, 0.01 * i, 0.4]} for i in range(50)]
    search = {"population": 1000, "iterations": 1000}
    slow = {**REQUEST, "path": {"waypoints": waypoints}, "ik": search, "budget_s": 100}
    lines = [json.dumps(r) for r in (GOOD[0], slow, *GOOD[1:])]
    command = [sys.executable, "-c", KILLING, json.dumps(lines)]
    done = subprocess.run(command, capture_output=True, timeout=60, check=False)
    assert done.returncode == 0, done.stderr
    first, lost, *others = json.loads(done.stdout)
    assert lost["type"] == "urn:ikplan:worker-lost"
    assert lost["exit_code"] == -9
    assert all(isinstance(size, int) for size in (first, *others))


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["/no/such.jsonl"], "/no/such.jsonl: No such file"),
        ([os.devnull], "at least one line"),
        (["requests.jsonl", "--workers", "-1"], "--workers"),
        (["requests.jsonl", "--tip", "tool0"], "--robot"),
        (["requests.jsonl", "-o", "/no/such/folder/plans.jsonl"], "/no/such/folder"),
        (["requests.jsonl", "--server", "http://127.0.0.1:1"], "cannot reach"),
    ],
)
def test_a_batch_that_cannot_be_done_is_one_line_that_helps(
    arguments, words, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path("requests.jsonl").write_bytes(json_lines(*GOOD))
    assert main(["batch", *arguments]) == (3 if "--server" in arguments else 2)
    output = capsys.readouterr()
    assert output.out == ""
    (line,) = output.err.splitlines()
    assert line.startswith("ikplan: ")
    assert words in line
