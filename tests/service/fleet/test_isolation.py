"""What one key stores, no other key reads, watches, cancels, deletes, lists or notices."""

from __future__ import annotations

import asyncio
import contextlib
import json
import sqlite3
from pathlib import Path
from typing import Any

import httpx
import pytest

from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.store.owners import EVERYONE, scoped, unscoped
from ikplan_api.store.sqlite_plans import SqlitePlanStore

from ..bad_requests import GOOD
from ..urdfs import ARM
from .replicas import ENTRIES, Replica, key, served, until

ASYNC = {"prefer": "respond-async"}
SCENE = {
    "obstacles": [
        {"name": "far", "shape": {"type": "sphere", "radius": 0.1}, "position": [2.0, 2.0, 0.0]}
    ]
}


@pytest.fixture(params=["file", "postgres"])
def place(request: pytest.FixtureRequest) -> str:
    if request.param == "file":
        return ":memory:"
    return str(request.getfixturevalue("database"))


async def fill(replica: Replica, name: str) -> dict[str, str]:
    """Store one of each for a key; return the ids that stand in the paths of routes."""
    http, headers = replica.http, key(name)
    robot = (await http.post("/v1/robots", json={"urdf": ARM}, headers=headers)).json()["name"]
    scene = (await http.post("/v1/scenes", json=SCENE, headers=headers)).json()["id"]
    plan = (await http.post("/v1/plans", json=GOOD, headers=headers)).json()["id"]
    replica.planner.go.clear()
    request = {**GOOD, "ik": {"seed": 5}}
    accepted = await http.post("/v1/plans", json=request, headers={**headers, **ASYNC})
    assert accepted.status_code == 202
    return {"name": robot, "scene_id": scene, "plan_id": plan, "job": accepted.json()["id"]}


def test_no_route_shows_or_changes_what_is_another_keys(place: str) -> None:
    async def use(here: Replica, there: Replica) -> None:
        there.jobs.park_queued() if there is not here else None
        ids = await fill(here, "anna")
        document = (await here.http.get("/openapi.json")).json()
        asked = 0
        for path, methods in document["paths"].items():
            for method in methods:
                if "{" not in path:
                    continue
                for plan_id in (ids["plan_id"], ids["job"]):
                    url = path.format(**{**ids, "plan_id": plan_id})
                    answer = await there.http.request(method.upper(), url, headers=key("berta"))
                    assert answer.status_code == 404, (method, url)
                    none = {k: v[: v.rfind("-") + 1] + "0" * 32 for k, v in ids.items()}
                    other = path.format(**none)
                    unknown = await there.http.request(method.upper(), other, headers=key("berta"))
                    assert shape(answer, url) == shape(unknown, other), (method, url)
                    asked += 1
        assert asked >= 14
        named = {**GOOD, "robot": ids["name"]}
        posted = {
            "/v1/plans": [named, {**GOOD, "scene": ids["scene_id"]}],
            "/v1/fk": [{"robot": ids["name"], "q": [0.0] * 6}],
            "/v1/ik": [{"robot": ids["name"], "position": [0.1, 0.1, 0.1]}],
            "/v1/timings": [{"robot": ids["name"], "waypoints": [[0.0] * 6, [0.1] * 6]}],
        }
        for path, requests in posted.items():
            for request in requests:
                answer = await there.http.post(path, json=request, headers=key("berta"))
                assert answer.status_code in (404, 422), path
                assert answer.json()["type"] in (
                    "urn:ikplan:robot-not-found",
                    "urn:ikplan:invalid-request",
                )
        line = json.dumps(named)
        ndjson = {"content-type": "application/x-ndjson", **key("berta")}
        batch = await there.http.post("/v1/batches", content=line, headers=ndjson)
        assert json.loads(batch.text)["problem"]["type"] == "urn:ikplan:robot-not-found"
        listed = (await there.http.get("/v1/plans", headers=key("berta"))).json()
        assert listed == {"plans": [], "next": None}
        robots = (await there.http.get("/v1/robots", headers=key("berta"))).text
        assert ids["name"] not in robots
        # All of it is still there for who owns it.
        headers = key("anna")
        assert (await there.http.get(f"/v1/plans/{ids['plan_id']}", headers=headers)).is_success
        assert (await there.http.get(f"/v1/plans/{ids['job']}", headers=headers)).status_code == 202
        assert (await there.http.get(f"/v1/robots/{ids['name']}", headers=headers)).is_success
        assert (await there.http.get(f"/v1/scenes/{ids['scene_id']}", headers=headers)).is_success
        listed = (await there.http.get("/v1/plans", headers=headers)).json()
        assert {plan["id"] for plan in listed["plans"]} == {ids["plan_id"], ids["job"]}
        here.planner.go.set()

    served(place, use, api_keys=",".join(ENTRIES))


def shape(answer: httpx.Response, url: str) -> tuple[Any, ...]:
    """All of an answer but the id that was asked for and that of the request."""
    text = answer.text.replace(answer.headers["x-request-id"], "")
    for part in url.split("/")[3:]:
        text = text.replace(part, "ID")
    return answer.status_code, text, sorted(answer.headers)


def test_equal_requests_of_two_keys_are_two_plans_and_neither_answer_tells(place: str) -> None:
    async def use(here: Replica, _: Replica) -> None:
        first = await here.http.post("/v1/plans", json=GOOD, headers=key("anna"))
        second = await here.http.post("/v1/plans", json=GOOD, headers=key("berta"))
        assert first.json()["id"] == second.json()["id"]
        assert len(here.planner.made) == 2  # berta waits as long as anna did
        differing = {k for k in first.headers if first.headers[k] != second.headers.get(k)}
        assert differing <= {"x-request-id", "content-length", "date"}
        made = [answer.json() for answer in (first, second)]
        for plan in made:
            del plan["stats"]  # how long each took
        assert made[0] == made[1]
        gone = f"/v1/plans/{first.json()['id']}"
        assert (await here.http.delete(gone, headers=key("anna"))).status_code == 204
        assert (await here.http.get(gone, headers=key("anna"))).status_code == 404
        assert (await here.http.get(gone, headers=key("berta"))).status_code == 200

    served(place, use, api_keys=",".join(ENTRIES))


def test_a_job_of_another_key_with_the_same_request_begins_anew(place: str) -> None:
    async def use(here: Replica, there: Replica) -> None:
        here.planner.go.clear()
        there.planner.go.clear()
        first = await here.http.post("/v1/plans", json=GOOD, headers={**key("anna"), **ASYNC})
        path = first.headers["location"]

        async def running() -> bool:
            answer = await here.http.get(path, headers=key("anna"))
            return bool(answer.json()["state"] == "running")

        await asyncio.wait_for(until(running), 60)
        second = await here.http.post("/v1/plans", json=GOOD, headers={**key("berta"), **ASYNC})
        assert second.json() == first.json()
        assert second.json()["state"] == "queued"
        assert (await here.http.delete(path, headers=key("berta"))).status_code == 204
        assert (await here.http.get(path, headers=key("anna"))).status_code == 202
        here.planner.go.set()
        there.planner.go.set()

    served(place, use, api_keys=",".join(ENTRIES))


def test_keys_share_what_is_stored_where_they_are_told_to(place: str) -> None:
    async def use(here: Replica, there: Replica) -> None:
        made = await here.http.post("/v1/plans", json=GOOD, headers=key("anna"))
        path = made.headers["content-location"]
        assert (await there.http.get(path, headers=key("berta"))).status_code == 200

    served(place, use, api_keys=",".join(ENTRIES), shared_store=True)


def test_roles_bound_what_a_key_may_do(place: str) -> None:
    async def use(here: Replica, _: Replica) -> dict[str, list[int]]:
        found = {}
        for name in ("anna", "reader", "auditor", "monitor"):
            answers = [
                await here.http.post(
                    "/v1/fk", json={"robot": "ur5", "q": [0] * 6}, headers=key(name)
                ),
                await here.http.get("/v1/plans", headers=key(name)),
                await here.http.get("/v1/audit", headers=key(name)),
                await here.http.get("/metrics", headers=key(name)),
            ]
            assert all(
                a.json()["type"] == "urn:ikplan:access-denied" for a in answers if a.is_error
            )
            found[name] = [answer.status_code for answer in answers]
        return found

    assert served(place, use, api_keys=",".join(ENTRIES)) == {
        "anna": [200, 200, 403, 200],
        "reader": [403, 200, 403, 200],
        "auditor": [403, 200, 200, 200],
        "monitor": [403, 403, 403, 200],
    }


def test_a_key_has_as_many_jobs_as_it_may_have(place: str) -> None:
    async def use(here: Replica, there: Replica) -> list[int]:
        here.planner.go.clear()
        there.planner.go.clear()
        codes = []
        for name, seed in (("berta", 1), ("berta", 2), ("berta", 3), ("anna", 3)):
            request, headers = {**GOOD, "ik": {"seed": seed}}, {**key(name), **ASYNC}
            answer = await here.http.post("/v1/plans", json=request, headers=headers)
            codes.append(answer.status_code)
            if answer.status_code == 503:
                assert "as many as it may have" in answer.json()["detail"]
                assert "retry-after" in answer.headers
        here.planner.go.set()
        there.planner.go.set()
        return codes

    assert served(place, use, api_keys=",".join(ENTRIES)) == [202, 202, 503, 202]


def test_the_audit_tells_who_planned_what(place: str) -> None:
    async def use(here: Replica, _: Replica) -> list[tuple[str, str, str]]:
        for name in ("anna", "berta"):
            made = await here.http.post("/v1/plans", json=GOOD, headers=key(name))
            assert made.status_code == 200
        await here.http.get("/v1/plans", headers=key("anna"))  # stored by now
        await here.http.get("/v1/plans", headers=key("berta"))
        await here.http.delete(made.headers["content-location"], headers=key("berta"))
        entries: list[Any] = []
        before: dict[str, int] = {}
        while True:
            query = {"limit": 2, **before}
            page = (await here.http.get("/v1/audit", params=query, headers=key("auditor"))).json()
            entries += page["entries"]
            if page["next"] is None:
                break
            before = {"before": page["next"]}
        only = await here.http.get("/v1/audit?owner=anna", headers=key("auditor"))
        assert {entry["owner"] for entry in only.json()["entries"]} == {"anna"}
        return [(e["owner"], e["action"], e["robot"]) for e in entries if e["action"] != "claimed"]

    assert served(place, use, api_keys=",".join(ENTRIES)) in (
        [
            ("berta", "deleted", robot),
            ("berta", "finished", "iiwa14"),
            ("anna", "finished", "iiwa14"),
        ]
        for robot in ("", "iiwa14")
    )


def test_a_file_of_the_first_version_keeps_its_plans_and_stays_shared(tmp_path: Path) -> None:
    path = tmp_path / "store.sqlite3"
    with contextlib.closing(sqlite3.connect(path)) as file:
        file.executescript(FIRST_VERSION)

    async def use() -> None:
        store = SqlitePlanStore(str(path), 100, 10**6, 3600.0 * 24 * 365 * 100)
        await store.open()
        assert store.shared
        assert await store.get("p") == b"plan"
        assert [job.plan_id for job in await store.pending()] == ["j"]
        assert await store.row("PRAGMA auto_vacuum", ()) == (2,)
        await store.put("q", b"2")
        await store.close()
        await store.open()
        assert store.shared
        assert await store.get("q") == b"2"
        await store.close()

    asyncio.run(use())
    keys = ",".join(ENTRIES)
    app = create_app(Settings(store_path=str(path), api_keys=keys))
    assert app.state.store is not None


@pytest.mark.parametrize("name", ["p", "a:p", ":p", "a:b:c", ""])
@pytest.mark.parametrize("owner", [EVERYONE, "a", "b"])
def test_no_name_of_one_owner_is_that_of_another(owner: str, name: str) -> None:
    assert unscoped(scoped(owner, name)) == name
    others = [(o, n) for o in ("", "a", "b") for n in ("p", "a:p", ":p", "a:b:c", "")]
    same = [other for other in others if scoped(*other) == scoped(owner, name)]
    assert same == [(owner, name)]


FIRST_VERSION = """
CREATE TABLE plans (
    id TEXT PRIMARY KEY, bytes INTEGER NOT NULL, made REAL NOT NULL, used REAL NOT NULL
);
CREATE INDEX plans_by_use ON plans (used, id, bytes);
CREATE TABLE documents (id TEXT PRIMARY KEY, document BLOB NOT NULL);
CREATE TABLE jobs (
    place INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, kind TEXT NOT NULL,
    budget_s REAL NOT NULL, accepted REAL NOT NULL, problem BLOB, robot BLOB,
    document BLOB NOT NULL
);
CREATE TABLE robots (
    name TEXT PRIMARY KEY, bytes INTEGER NOT NULL, used REAL NOT NULL, document BLOB NOT NULL,
    info BLOB NOT NULL
);
CREATE VIEW kept AS SELECT id, made, document FROM plans JOIN documents USING (id);
CREATE TRIGGER keep INSTEAD OF INSERT ON kept BEGIN
    INSERT INTO documents VALUES (NEW.id, NEW.document)
        ON CONFLICT (id) DO UPDATE SET document = excluded.document;
    INSERT INTO plans VALUES (NEW.id, length(NEW.document), NEW.made, NEW.made)
        ON CONFLICT (id) DO UPDATE SET
            bytes = excluded.bytes, made = excluded.made, used = excluded.used;
    DELETE FROM jobs WHERE id = NEW.id;
END;
CREATE TRIGGER forget AFTER DELETE ON plans BEGIN
    DELETE FROM documents WHERE id = OLD.id;
END;
PRAGMA user_version = 1;
INSERT INTO kept VALUES ('p', 1700000000.0, CAST('plan' AS BLOB));
INSERT INTO jobs (id, kind, budget_s, accepted, document)
    VALUES ('j', 'plan', 1.0, 1700000000.0, CAST('{}' AS BLOB));
"""
