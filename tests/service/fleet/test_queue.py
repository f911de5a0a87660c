"""The queue in PostgreSQL: who has a job, until when, and whose end of it counts."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import psycopg
import pytest

from ikplan_api.store.document_store import StoredDocument
from ikplan_api.store.plan_query import PlanQuery
from ikplan_api.store.plan_store import Job
from ikplan_api.store.postgres.documents import PostgresDocumentStore
from ikplan_api.store.postgres.store import PostgresBounds, PostgresStore

JOB = Job("j", "plan", b"{}", None, 10.0, owner="anna", robot_name="ur5")
PLAN = b'{"plan": "%s"}' % (b"x" * 5000)
PROBLEM = json.dumps({"type": "urn:ikplan:unreachable", "status": 422}).encode()


def use(
    database: str,
    scenario: Callable[[PostgresStore, PostgresStore], Awaitable[Any]],
    lease_s: float = 30.0,
    objects: str = "",
    **bounds: Any,
) -> Any:
    """Run a scenario with the stores of two replicas."""
    most = {"max_plans": 100, "max_bytes": 10**7, "max_age_s": 3600.0, "object_bytes": 50, **bounds}

    async def run() -> Any:
        stores = [
            PostgresStore(database, PostgresBounds(**most), lease_s=lease_s, object_url=objects)
            for _ in range(2)
        ]
        await asyncio.gather(*(store.open() for store in stores))  # both migrate
        try:
            async with asyncio.timeout(60):
                return await scenario(*stores)
        finally:
            for store in stores:
                await store.close()

    return asyncio.run(run())


def audited(database: str) -> list[tuple[Any, ...]]:
    with psycopg.connect(database) as connection:
        return connection.execute(
            "SELECT action, owner, subject, attempt FROM audit ORDER BY place"
        ).fetchall()


def test_a_job_is_claimed_once_and_its_plan_is_found_by_both(database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> None:
        assert (await here.queue.accept(JOB)).state == "queued"
        claims = await asyncio.gather(
            *(store.queue.claim(expired=False) for store in (here, there) * 3)
        )
        (claim,) = [claim for claim in claims if claim is not None]
        owner = here if claims.index(claim) % 2 == 0 else there
        assert claim == (JOB._replace(robot=None), 1, True)
        row = await there.queue.look("j", "anna")
        assert row is not None
        assert row.status.state == "running"
        assert await owner.queue.finish(claim, PLAN)
        assert await here.plans.get("j", "anna") == PLAN
        assert await there.plans.get("j", "anna") == PLAN
        assert await there.plans.get("j", "berta") is None
        assert await there.queue.look("j", "anna") is None

    use(database, run)
    assert [row[0] for row in audited(database)] == ["accepted", "claimed", "finished"]


def test_a_lease_that_ends_lets_another_take_over_and_fences_off_the_first(database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> None:
        await here.queue.accept(JOB)
        first = await here.queue.claim(expired=False)
        assert first is not None
        assert await there.queue.claim(expired=True) is None
        assert await here.queue.renew(first)
        await asyncio.sleep(1.2)
        second = await there.queue.claim(expired=True)
        assert second is not None
        assert second.attempt == 2
        assert not await here.queue.renew(first)
        assert not await here.queue.fail(first, PROBLEM)
        assert not await here.queue.release(first)
        assert not await here.queue.finish(first, b"late")
        assert await here.plans.get("j", "anna") is None
        assert await there.queue.finish(second, PLAN)
        assert await here.plans.get("j", "anna") == PLAN

    use(database, run, lease_s=1.0)
    ends = [(action, attempt) for action, _, _, attempt in audited(database)]
    assert ends == [("accepted", 0), ("claimed", 1), ("claimed", 2), ("late", 1), ("finished", 2)]


def test_a_failure_is_kept_for_who_asks_and_forgotten_when_it_is_accepted_again(
    database: str,
) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> None:
        await here.queue.accept(JOB)
        claim = await here.queue.claim(expired=False)
        assert claim is not None
        assert await here.queue.fail(claim, PROBLEM)
        row = await there.queue.look("j", "anna")
        assert row is not None
        assert (row.status.state, row.problem) == ("failed", PROBLEM)
        (listed,) = await there.plans.list(PlanQuery("anna", 10))
        assert (listed.outcome, listed.problem) == ("failed", "urn:ikplan:unreachable")
        assert (await there.queue.accept(JOB)).state == "queued"
        again = await there.queue.claim(expired=False)
        assert again is not None
        assert again.attempt == 1

    use(database, run)


def test_a_request_that_a_client_waits_for_is_seen_but_never_queued(database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> None:
        claim = await here.queue.begin(JOB)
        assert claim is not None
        assert await there.queue.begin(JOB) is None
        assert await there.queue.look("j", "anna") is not None
        await asyncio.sleep(1.2)
        assert await there.queue.claim(expired=True) is None  # its client is gone, too
        assert await there.queue.look("j", "anna") is None
        assert await there.queue.begin(JOB) is not None

    use(database, run, lease_s=1.0)


def test_a_request_becomes_a_job_when_it_is_accepted_while_it_runs(database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> None:
        claim = await here.queue.begin(JOB)
        assert claim is not None
        assert (await there.queue.accept(JOB)).state == "running"
        assert not await here.queue.abandon(claim)
        assert await here.queue.release(claim)
        assert await there.queue.claim(expired=False) is not None

    use(database, run)


def test_changes_are_told_to_the_other_replica_in_order(database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> list[Any]:
        heard = []
        with there.changes.of(("anna", "j")) as changes:
            assert await asyncio.wait_for(changes.get(), 10) is None  # it listens
            await here.queue.accept(JOB)
            claim = await here.queue.claim(expired=False)
            assert claim is not None
            await here.queue.progress(claim, "ik", 1, 5)
            await here.queue.finish(claim, PLAN)
            for _ in range(3):
                change = await asyncio.wait_for(changes.get(), 10)
                assert change is not None
                heard.append((change["state"], change.get("stage"), change.get("done")))
        return heard

    heard = use(database, run)
    assert heard == [("queued", None, None), ("running", "ik", 1), ("finished", None, None)]


def test_long_plans_are_in_the_object_store_and_go_with_their_rows(
    database: str, tmp_path: Path
) -> None:
    short, long = b"{}", bytes(range(256)) * 40

    async def run(here: PostgresStore, there: PostgresStore) -> list[int]:
        counts = []
        for plan_id, document in (("short", short), ("long", long)):
            stored = await here.plans.prepare(plan_id, document, "anna", "plan", "ur5")
            await here.plans.put(stored)
            assert await there.plans.get(plan_id, "anna") == document
            counts.append(sum(path.is_file() for path in tmp_path.rglob("*")))
        second = await there.plans.prepare("long", b"y" + long, "anna", "plan", "ur5")
        await there.plans.put(second)  # the first one stays
        assert await here.plans.get("long", "anna") == long
        counts.append(sum(path.is_file() for path in tmp_path.rglob("*")))
        assert await there.queue.delete("long", "anna")
        assert not await here.queue.delete("long", "anna")
        return [*counts, sum(path.is_file() for path in tmp_path.rglob("*"))]

    assert use(database, run, objects=tmp_path.as_uri()) == [0, 1, 1, 0]


def test_the_purge_deletes_what_was_unused_for_longest(database: str) -> None:
    async def run(here: PostgresStore, _: PostgresStore) -> list[str]:
        for i in range(8):
            stored = await here.plans.prepare(f"p{i}", PLAN, "anna", "plan", "ur5")
            await here.plans.put(stored)
        async with here.database.connection() as connection:
            await connection.execute(
                "UPDATE plans SET used = used - interval '1 day' WHERE id < 'p4'"
            )
        await here.plans.get("p2", "anna")
        await here.plans.purge()
        return [row.plan_id for row in await here.plans.list(PlanQuery("anna", 100))]

    assert sorted(use(database, run, max_plans=5)) == ["p2", "p4", "p5", "p6", "p7"]


@pytest.mark.parametrize("limit", [1, 3, 5])
def test_pages_of_a_list_are_the_whole_list(limit: int, database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> list[str]:
        for i in range(5):
            robot = "ur5" if i % 2 else "iiwa14"
            await here.plans.put(await here.plans.prepare(f"p{i}", PLAN, "anna", "plan", robot))
        await here.plans.put(await here.plans.prepare("other", PLAN, "berta", "plan", "ur5"))
        await here.queue.accept(JOB)
        ids, after = [], None
        while True:
            rows = await there.plans.list(PlanQuery("anna", limit, after=after))
            ids += [row.plan_id for row in rows[:limit]]
            if len(rows) <= limit:
                only = await there.plans.list(PlanQuery("anna", 9, robot="ur5"))
                assert [row.plan_id for row in only] == ["j", "p3", "p1"]
                return ids
            after = rows[limit - 1].time, rows[limit - 1].plan_id

    assert use(database, run) == ["j", "p4", "p3", "p2", "p1", "p0"]


def test_robots_and_scenes_are_apart_by_owner_and_kind_and_bounded(database: str) -> None:
    async def run(here: PostgresStore, there: PostgresStore) -> None:
        robots = PostgresDocumentStore(here.database, "robots", 2, 100)
        same = PostgresDocumentStore(there.database, "robots", 2, 100)
        scenes = PostgresDocumentStore(there.database, "scenes", 2, 100)
        document = StoredDocument(b"1" * 10, b"2")
        assert await robots.put("a", document, "anna")
        assert not await same.put("a", document, "anna")
        assert await same.get("a", "anna") == document
        assert await same.get("a", "berta") is None
        assert await scenes.get("a", "anna") is None
        assert not await same.delete("a", "berta")
        await robots.put("b", document, "anna")
        await robots.put("c", document, "berta")
        await robots.put("d", document, "anna")
        assert await same.names("anna") == ["b", "d"]
        assert await same.names("berta") == ["c"]
        assert await same.delete("b", "anna")
        assert await robots.names("anna") == ["d"]

    use(database, run)
