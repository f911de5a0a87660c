"""What an attacker uploads is refused quickly, with the reason, before Pinocchio sees anything."""

from __future__ import annotations

import resource
import time

import httpx
import pytest
from fastapi import FastAPI

from .urdfs import ARM, DROPPED_MESHES, HOSTILE

XML = {"content-type": "application/xml"}
SECOND = 1.0
MEMORY_KB = 64 * 1024


@pytest.mark.parametrize("name", HOSTILE)
@pytest.mark.parametrize("form", ["xml", "json"])
def test_it_is_refused_with_the_reason_within_a_second(
    name: str, form: str, http: httpx.Client
) -> None:
    sent, said = HOSTILE[name]
    before, started = resource.getrusage(resource.RUSAGE_SELF), time.process_time()
    if form == "xml":
        answer = http.post("/v1/robots", content=sent, headers=XML)
    else:
        answer = http.post("/v1/robots", json={"urdf": sent})
    spent = time.process_time() - started
    after = resource.getrusage(resource.RUSAGE_SELF)
    assert answer.status_code == 422
    problem = answer.json()
    assert problem["type"] == "urn:ikplan:invalid-robot"
    assert said in problem["detail"]
    assert len(answer.content) < 20_000
    assert spent < SECOND
    assert after.ru_maxrss - before.ru_maxrss < MEMORY_KB


@pytest.mark.parametrize("name", DROPPED_MESHES)
def test_an_address_of_a_mesh_is_dropped_and_never_followed(name: str, http: httpx.Client) -> None:
    sent, said = DROPPED_MESHES[name]
    answer = http.post("/v1/robots", content=sent, headers=XML)
    assert answer.status_code in (200, 201)
    robot = answer.json()
    (note,) = [note for note in robot["notes"] if "dropped" in note]
    assert said in note
    seen = http.get(f"/v1/robots/{robot['name']}/visual")
    assert seen.status_code == 200
    assert "mesh" not in seen.text
    assert "passwd" not in seen.text
    http.delete(f"/v1/robots/{robot['name']}")


@pytest.mark.parametrize("form", ["xml", "json", "srdf"])
def test_five_megabytes_are_not_read_to_the_end(form: str, http: httpx.Client) -> None:
    sent = ARM + " " * (5 * 2**20)
    started = time.process_time()
    if form == "xml":
        answer = http.post("/v1/robots", content=sent, headers=XML)
    else:
        body = {"urdf": sent} if form == "json" else {"urdf": ARM, "srdf": sent}
        answer = http.post("/v1/robots", json=body)
    assert (answer.status_code, answer.json()["allowed"]) in (
        (413, f"at most {2**20} bytes"),
        (422, "at most 2000000"),
    )
    assert time.process_time() - started < SECOND


def test_nothing_hostile_reaches_the_process_that_builds(
    http: httpx.Client, app: FastAPI, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def build(*_: object, **__: object) -> None:
        raise AssertionError("reached")

    monkeypatch.setattr(app.state.robot_builder, "build", build)
    for name, (sent, _) in HOSTILE.items():
        assert http.post("/v1/robots", content=sent, headers=XML).status_code == 422, name
