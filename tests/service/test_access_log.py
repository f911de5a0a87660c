"""What the real command writes of requests: one line each, none of probes."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import threading

import httpx

WAIT_S = 120.0
ASKED = ["/v1/robots", "/v1/solvers", "/v1/robots/ur5", "/v1/plans/none", "/nowhere"]
PROBES = ["/livez", "/readyz", "/metrics"]


def test_every_request_is_one_line_and_probes_are_none() -> None:
    environment = {**os.environ, "IKPLAN_LOG_FORMAT": "json", "IKPLAN_STORE_PATH": ":memory:"}
    command = [sys.executable, "-m", "ikplan", "serve", "--port", "0", "--workers", "1"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True, env=environment)
    assert process.stderr is not None
    overdue = threading.Timer(WAIT_S, process.kill)
    overdue.start()
    try:
        lines = []
        for line in process.stderr:
            lines.append(line)
            if match := re.search(r"http://127\.0\.0\.1:\d+", line):
                break
        else:
            raise AssertionError("".join(lines))
        with httpx.Client(base_url=match[0], timeout=60.0) as http:
            for path in [*ASKED, *PROBES, *PROBES]:
                http.get(path, params={"word": "secret"})
        process.send_signal(signal.SIGTERM)
        _, rest = process.communicate(timeout=WAIT_S)
    finally:
        overdue.cancel()
        process.kill()
        process.wait()
    records = [json.loads(line) for line in rest.splitlines() if line.startswith("{")]
    access = [record for record in records if record.get("path")]
    assert [record["path"] for record in access] == ASKED
    assert {record["logger"] for record in access} == {"ikplan.access"}
    assert not [record for record in records if record["logger"] == "uvicorn.access"]
    assert not [record for record in records if "color_message" in record]
    assert not re.search("livez|readyz|metrics", rest)
    assert "secret" not in rest  # a query may hold what no log may
