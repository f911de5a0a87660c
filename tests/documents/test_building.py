"""When documents are built, and that several threads may use one first."""

from __future__ import annotations

import json
import subprocess
import sys

import pytest

THREADS = """
import sys
sys.setswitchinterval(1e-6)
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier
from ikplan.documents.plan_request import PlanRequest
from ikplan.documents import parse
from ikplan.errors import InvalidRequest
barrier = Barrier(8)
def check(k):
    barrier.wait()
    document = {"robot": "ur5", "path": {"waypoints": [{"position": [0.3, 0.1, 0.1 * k]}]}}
    if k % 2:
        document["path"]["waypoints"][0]["colour"] = "red"
    try:
        return parse(PlanRequest, document).path.waypoints[0].position[2]
    except InvalidRequest as error:
        return error.field
with ThreadPoolExecutor(8) as pool:
    import json
    print(json.dumps(list(pool.map(check, range(8)))))
"""


def run(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return done.stdout


def test_threads_that_use_a_document_first_at_the_same_time_have_it_checked() -> None:
    wrong = "path.waypoints[0].colour"
    right = [pytest.approx(0.1 * k) if k % 2 == 0 else wrong for k in range(8)]
    assert json.loads(run(THREADS)) == right


def test_documents_are_built_when_they_are_used_and_not_before() -> None:
    code = (
        "from ikplan.documents import AT_FIRST_USE\n"
        "from ikplan.documents.plan_request import PlanRequest\n"
        "from ikplan.documents.requests.fk import FkRequest\n"
        "built = [PlanRequest.__pydantic_complete__, FkRequest.__pydantic_complete__]\n"
        "FkRequest(robot='ur5', q=[0.1])\n"
        "built += [PlanRequest.__pydantic_complete__, FkRequest.__pydantic_complete__]\n"
        "early = not AT_FIRST_USE\n"
        "assert built == [early, early, early, True], built\n"
    )
    run(code)
