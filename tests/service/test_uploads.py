"""Robots of one's own, over HTTP: in, used, described, forgotten."""

from __future__ import annotations

import contextlib
import json
from collections.abc import AsyncIterator, Iterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import Client, InvalidRobot, RobotNotFound
from ikplan.cli import main
from ikplan.robots import robot_from_urdf
from ikplan_api.robots.build_robot import build_upload
from ikplan_api.robots.robot_builder import RobotBuilder
from ikplan_api.store.document_store import DocumentStore, MemoryDocumentStore, StoredDocument
from ikplan_api.store.sqlite_documents import SqliteDocumentStore
from ikplan_api.store.sqlite_plans import SqlitePlanStore
from tests.measured import check_motion, waypoint_errors

from .urdfs import ARM, chain

XML = {"content-type": "application/xml"}
Q = [0.1, 0.5, -0.2, 0.7, 0.3, 0.6]


@pytest.fixture(scope="module")
def arm(client: Client) -> Iterator[str]:
    name = client.upload_robot(ARM, title="Arm")["name"]
    yield name
    client.delete_robot(name)


def test_an_upload_is_described_listed_and_answered_again(http: httpx.Client, arm: str) -> None:
    again = http.post("/v1/robots", json={"urdf": ARM, "title": "Arm"})
    assert again.status_code == 200
    assert again.headers["location"] == f"/v1/robots/{arm}"
    described = http.get(again.headers["location"]).json()
    assert described == again.json()
    assert (described["name"], described["title"], described["dof"]) == (arm, "Arm", 6)
    assert {**described, "collision": None} in http.get("/v1/robots").json()["robots"]


def test_a_urdf_can_be_sent_as_it_is(http: httpx.Client) -> None:
    answer = http.post("/v1/robots?tip=l4&title=Short", content=ARM, headers=XML)
    assert answer.status_code == 201
    info = answer.json()
    assert (info["tip_frame"], info["dof"], info["title"]) == ("l4", 4, "Short")
    twin = http.post("/v1/robots", json={"urdf": ARM, "tip": "l4", "title": "Short"})
    assert (twin.status_code, twin.json()) == (200, info)
    assert http.delete(f"/v1/robots/{info['name']}").status_code == 204


def test_every_request_can_name_it(client: Client, arm: str) -> None:
    local = robot_from_urdf(ARM)
    pose = local.fk(Q)
    assert np.array_equal(client.fk({"robot": arm, "q": Q}).position, pose.translation)
    target = {"position": pose.translation, "quaternion_xyzw": [0, 0, 0, 1]}
    solution = client.ik({"robot": arm, "position": target["position"], "start": Q})
    reached = local.fk(solution.q).translation
    assert np.linalg.norm(reached - pose.translation) <= 1e-6
    path: dict[str, Any] = {
        "waypoints": [{"position": pose.translation}, {"position": local.fk([0] * 6)}]
    }
    path["waypoints"][1]["position"] = local.fk([v + 0.1 for v in Q]).translation
    plan = client.plan({"robot": arm, "start": Q, "path": path})
    check_motion(plan.trajectory, local, ends=(Q, plan.waypoints.q[-1]))
    assert waypoint_errors(plan, path, local).max() <= 1e-8
    assert plan.robot == arm
    ends = local.fk(plan.trajectory.q[-1]).translation
    assert np.linalg.norm(ends - path["waypoints"][1]["position"]) <= 1e-4
    assert client.plan({"robot": arm, "start": Q, "path": path}).id == plan.id
    timed = client.time({"robot": arm, "waypoints": [Q, [0.0] * 6]})
    check_motion(timed.trajectory, local, ends=(Q, [0.0] * 6))


def test_torques_of_a_robot_without_inertias_are_refused_with_the_reason(
    client: Client, arm: str
) -> None:
    request = {"robot": arm, "waypoints": [Q, [0.0] * 6], "limits": {"torque": True}}
    with pytest.raises(ikplan.InvalidRequest, match=r"link 'l1' .on joint 'j1'. has no mass"):
        client.time(request)


def test_a_forgotten_robot_is_not_found_and_neither_is_one_never_seen(
    client: Client, http: httpx.Client
) -> None:
    name = client.upload_robot(chain(3))["name"]
    client.delete_robot(name)
    for gone in (name, "urdf-" + "0" * 32):
        for call in (client.robot, client.delete_robot):
            with pytest.raises(RobotNotFound):
                call(gone)
        with pytest.raises(RobotNotFound, match="upload it again") as caught:
            client.fk({"robot": gone, "q": [0.0] * 3})
        assert "iiwa14" in caught.value.valid
    assert name not in http.get("/v1/robots").text


def test_the_catalogue_cannot_be_deleted(http: httpx.Client) -> None:
    answer = http.delete("/v1/robots/iiwa14")
    assert answer.status_code == 403
    assert "catalogue" in answer.json()["detail"]
    assert http.delete("/v1/robots/iiwa41").status_code == 404
    assert http.get("/v1/robots/iiwa14").status_code == 200


@pytest.mark.parametrize(
    ("query", "headers", "body", "status", "said"),
    [
        ("", {"content-type": "text/plain"}, ARM, 415, "application/json or application/xml"),
        ("", {}, ARM, 415, "but it is missing"),
        ("?home=1", XML, ARM, 422, "home: unknown field; known fields: base, tip, title"),
        ("?tip=l3", {"content-type": "application/json"}, "{}", 422, "into the document"),
        ("?tip=zz", XML, ARM, 422, "no link 'zz' to be the tip"),
        ("", {"content-type": "application/json"}, '{"urdf": 1}', 422, "urdf"),
        ("", {"content-type": "application/json"}, '{"urdf": "<a/>", "x": 1}', 422, "unknown"),
        ("", XML, ARM.encode("utf-16"), 422, "not UTF-8"),
        ("", XML, "", 422, "urdf: wants at least 1 character"),
    ],
)
def test_a_wrong_upload_is_told_what_is_wrong(
    http: httpx.Client,
    query: str,
    headers: dict[str, str],
    body: str | bytes,
    status: int,
    said: str,
) -> None:
    answer = http.post(f"/v1/robots{query}", content=body, headers=headers)
    assert (answer.status_code, said in answer.json()["detail"]) == (status, True), answer.text


def test_the_client_raises_what_python_raises(client: Client) -> None:
    broken = ARM.replace('lower="-2.5"', 'lower="3"')
    with pytest.raises(InvalidRobot) as local:
        ikplan.robots.robot_from_urdf(broken, name="robot")
    with pytest.raises(InvalidRobot) as remote:
        client.upload_robot(broken)
    assert (remote.value.joint, remote.value.value) == (local.value.joint, local.value.value)
    assert remote.value.detail.partition(": ")[2] == local.value.detail.partition(": ")[2]


def robot(size: int) -> StoredDocument:
    return StoredDocument(b"d" * size, b"")


@contextlib.asynccontextmanager
async def robot_store(kind: str, path: Path | str, **bounds: int) -> AsyncIterator[DocumentStore]:
    if kind == "memory":
        yield MemoryDocumentStore(**bounds)
        return
    file = SqlitePlanStore(str(path), max_plans=9, max_bytes=10**6, max_age_s=3600.0)
    await file.open()
    yield SqliteDocumentStore(file, "robots", **bounds)
    await file.close()


@pytest.mark.anyio
@pytest.mark.parametrize("kind", ["memory", "sqlite"])
async def test_the_store_is_bounded_and_forgets_what_was_unused_for_longest(kind: str) -> None:
    async with robot_store(kind, ":memory:", max_documents=2, max_bytes=10) as store:
        assert [await store.put(n, robot(1)) for n in ("a", "b", "a")] == [True, True, False]
        assert await store.get("b") == robot(1)
        await store.put("c", robot(1))
        assert await store.names() == ["b", "c"]
        await store.put("d", robot(10))
        assert await store.names() == ["d"]
        await store.put("e", robot(11))
        assert "e" not in await store.names()
        assert not await store.delete("e")
        assert await store.get("e") is None
        assert await store.put("f", robot(10))
        assert await store.names() == ["f"]
        assert await store.delete("f")


@pytest.mark.anyio
async def test_robots_outlive_the_service(tmp_path: Path) -> None:
    bounds = {"max_documents": 9, "max_bytes": 100}
    async with robot_store("sqlite", tmp_path / "plans.sqlite", **bounds) as store:
        await store.put("a", robot(3))
    async with robot_store("sqlite", tmp_path / "plans.sqlite", **bounds) as store:
        assert await store.get("a") == robot(3)
        assert not await store.put("a", robot(4))


def document(urdf: str) -> bytes:
    return json.dumps({"urdf": urdf}).encode()


@pytest.mark.anyio
async def test_a_robot_that_needs_too_much_memory_ends_only_its_own_process() -> None:
    builder = RobotBuilder(max_bytes=200 * 2**20, timeout_s=20.0)
    with pytest.raises(InvalidRobot, match="more than 200 MiB of memory"):
        await builder.build(document(ARM), name="urdf-x")
    roomy = RobotBuilder(max_bytes=2**30, timeout_s=20.0)
    info = await roomy.build(document(ARM), name="urdf-x")
    assert info == build_upload(document(ARM))["info"]


@pytest.mark.anyio
async def test_a_robot_that_takes_too_long_is_given_up() -> None:
    builder = RobotBuilder(max_bytes=2**30, timeout_s=0.05)
    with pytest.raises(InvalidRobot, match=r"longer than 0\.05 s"):
        await builder.build(document(ARM), name="urdf-x")


@pytest.mark.anyio
async def test_the_disposable_process_says_what_is_wrong_with_a_robot() -> None:
    builder = RobotBuilder(max_bytes=2**30, timeout_s=20.0)
    with pytest.raises(InvalidRobot, match="no link 'x' to be the tip") as caught:
        await builder.build(json.dumps({"urdf": ARM, "tip": "x"}).encode(), name="urdf-x")
    assert caught.value.valid == [f"l{i}" for i in range(7)]


def test_64_joints_are_built(http: httpx.Client) -> None:
    answer: httpx.Response = http.post("/v1/robots", content=chain(64), headers=XML)
    assert answer.status_code == 201
    assert http.delete(answer.headers["location"]).status_code == 204


def test_the_command_uploads_the_robot_of_a_file(
    live_address: str, client: Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    urdf, rows, out = (tmp_path / name for name in ("arm.urdf", "rows.json", "timed.json"))
    urdf.write_text(ARM)
    rows.write_text(json.dumps([Q, [0.0] * 6]))
    options = ["--robot", str(urdf), "--tip", "l6", "--server", live_address, "-o", str(out)]
    assert main(["time", str(rows), *options]) == 0
    timed = ikplan.Plan.load(out.read_bytes())
    described = client.robot(timed.robot)
    assert (described["title"], described["tip_frame"]) == ("arm", "l6")
    assert timed.q[0].tolist() == Q
    client.delete_robot(timed.robot)
    assert timed.robot in capsys.readouterr().out
