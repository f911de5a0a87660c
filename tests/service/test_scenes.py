"""Scenes over HTTP: in, named by their id in every kind of request, described, forgotten."""

from __future__ import annotations

import contextlib
import json
import sqlite3
from collections.abc import AsyncIterator
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import AsyncClient, Client, InCollision, InvalidRequest, PlanRequest
from ikplan_api.app import create_app
from ikplan_api.settings import Settings
from ikplan_api.store.document_store import DocumentStore, MemoryDocumentStore, StoredDocument
from ikplan_api.store.sqlite_documents import SqliteDocumentStore
from ikplan_api.store.sqlite_plans import SqlitePlanStore

from .conftest import ADDRESS

TABLE = {
    "name": "table",
    "shape": {"type": "box", "size": [1.0, 1.0, 0.05]},
    "position": [0.6, 0.0, -0.3],
}
SCENE: dict[str, Any] = {"obstacles": [TABLE], "clearance": 0.002}
UR5 = ikplan.load_robot("ur5")


def tool_at(offset: list[float]) -> list[float]:
    place: list[float] = (UR5.fk(UR5.home).translation + np.array(offset)).tolist()
    return place


def request(**more: Any) -> dict[str, Any]:
    path = {"waypoints": [{"position": tool_at([0.0, 0.05, 0.0])}], "interpolation": "line"}
    return {"robot": "ur5", "path": path, **more}


def wall(offset: list[float]) -> dict[str, Any]:
    shape = {"type": "box", "size": [0.4, 0.02, 0.4]}
    return {"obstacles": [{"name": "wall", "shape": shape, "position": tool_at(offset)}]}


def test_a_scene_is_stored_under_the_hash_of_its_content(http: httpx.Client) -> None:
    first = http.post("/v1/scenes", json={**SCENE, "name": "cell 3"})
    assert first.status_code == 201
    told = first.json()
    assert (told["name"], told["obstacles"][0]["name"]) == ("cell 3", "table")
    assert first.headers["location"] == f"/v1/scenes/{told['id']}"
    assert http.get(first.headers["location"]).json() == told
    again = http.post("/v1/scenes", json={**SCENE, "self_collision": True})
    assert (again.status_code, again.json()["id"]) == (200, told["id"])
    other = http.post("/v1/scenes", json={**SCENE, "clearance": 0.003})
    assert (other.status_code, other.json()["id"] == told["id"]) == (201, False)
    for scene_id in (told["id"], other.json()["id"]):
        assert http.delete(f"/v1/scenes/{scene_id}").status_code == 204
        assert http.get(f"/v1/scenes/{scene_id}").status_code == 404
        assert http.delete(f"/v1/scenes/{scene_id}").status_code == 404


def test_a_plan_by_the_id_of_a_scene_is_the_plan_with_the_scene(client: Client) -> None:
    scene_id = client.upload_scene(SCENE)["id"]
    named = client.plan(request(scene=scene_id))
    assert named.id == client.plan(request(scene=SCENE)).id
    assert named.id == ikplan.plan(request(scene=SCENE)).id
    assert named.id != client.plan(request()).id
    assert named.certificate.clearance is not None
    assert named.certificate.clearance.scene.pair is not None
    assert "table" in named.certificate.clearance.scene.pair
    job = client.submit(request(scene=scene_id))
    client.delete_scene(scene_id)
    assert job.wait().id == named.id


def test_poses_timings_and_batches_name_scenes_too(client: Client) -> None:
    in_the_way = client.upload_scene(wall([0.0, 0.0, 0.0]))["id"]
    with pytest.raises(InCollision) as posed:
        client.ik({"robot": "ur5", "position": tool_at([0.0, 0.0, 0.0]), "scene": in_the_way})
    assert "wall" in posed.value.pair
    q = UR5.home.tolist()
    rows = [q, [q[0] + 0.2, *q[1:]]]
    with pytest.raises(InCollision) as timed:
        client.time({"robot": "ur5", "waypoints": rows, "scene": in_the_way})
    assert "wall" in timed.value.pair
    (line,) = client.batch([request(scene=in_the_way)])
    assert isinstance(line, InCollision)


def test_an_id_that_is_not_stored_is_told_with_what_to_do(
    client: Client, http: httpx.Client
) -> None:
    for scene_id in ("scene-" + "0" * 32, "table"):
        for send in (client.plan, client.submit):
            with pytest.raises(InvalidRequest, match="upload it by POST /v1/scenes") as caught:
                send(request(scene=scene_id))
            assert caught.value.field == "scene"
        with pytest.raises(InvalidRequest, match="no scene"):
            client.scene(scene_id)
        with pytest.raises(InvalidRequest, match="no scene"):
            client.delete_scene(scene_id)
    long = request(scene="scene-1", budget_s=10)
    long["path"]["waypoints"] *= 200
    assert http.post("/v1/plans", json=long).json()["field"] == "scene"
    with pytest.raises(InvalidRequest, match="a scene that a service holds"):
        ikplan.plan(request(scene="scene-1"))


@pytest.mark.parametrize(
    ("document", "field"),
    [
        ({"obstacles": [{**TABLE, "shape": {"type": "box", "size": [1, 0, 1]}}]}, "obstacles[0]"),
        ({"obstacles": [TABLE, TABLE]}, ""),
        ({"obstacles": [{**TABLE, "shape": {"type": "mesh", "file": "/etc/passwd"}}]}, "file"),
        ({"clearence": 1.0}, "clearence"),
    ],
)
def test_a_wrong_scene_is_refused_with_its_field(
    http: httpx.Client, document: dict[str, Any], field: str
) -> None:
    answer = http.post("/v1/scenes", json=document)
    assert answer.status_code == 422
    assert field in answer.json()["field"]


def test_a_service_opens_no_mesh_file(http: httpx.Client, tmp_path: Path) -> None:
    file = written_mesh(tmp_path)
    mesh = {**TABLE, "shape": {"type": "mesh", "file": str(file)}}
    for document in (
        request(scene={"obstacles": [mesh]}),
        request(tool={"geometry": [mesh]}),
    ):
        answer = http.post("/v1/plans", json=document)
        assert answer.status_code == 422
        assert "in Python, the shell" in answer.json()["detail"]


def written_mesh(folder: Path) -> Path:
    """A box of 100 mm as an OBJ in millimetres."""
    corners = [(x, y, z) for x in (-50, 50) for y in (-50, 50) for z in (-50, 50)]
    faces = [(1, 2, 4), (1, 4, 3), (5, 8, 6), (5, 7, 8), (1, 5, 6), (1, 6, 2)]
    faces += [(3, 4, 8), (3, 8, 7), (1, 3, 7), (1, 7, 5), (2, 6, 8), (2, 8, 4)]
    file = folder / "part.obj"
    file.write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"f {a} {b} {c}\n" for a, b, c in faces)
    )
    return file


def test_the_client_sends_the_hull_of_a_mesh_beside_it(
    client: Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written_mesh(tmp_path)
    monkeypatch.chdir(tmp_path)
    mesh = {"type": "mesh", "file": "part.obj", "scale": 0.001}
    part: dict[str, Any] = {"name": "part", "shape": mesh, "position": [0.6, 0.0, -0.3]}
    document = request(scene={"obstacles": [part]})
    here = ikplan.plan(document)
    assert client.plan(document).id == here.id
    assert client.plan(PlanRequest.model_validate(document)).id == here.id
    scene = ikplan.documents.scene.Scene.model_validate({"obstacles": [part]})
    uploaded = client.upload_scene(scene, name="part")
    assert uploaded["name"] == "part"
    assert len(uploaded["obstacles"][0]["shape"]["points"]) == 8
    assert client.plan(request(scene=uploaded["id"])).id == here.id
    assert client.plan(request(scene=scene)).id == here.id
    carried = {**part, "position": [0.0, 0.0, 0.06]}
    tool = request(tool={"geometry": [carried]})
    assert client.plan(tool).id == ikplan.plan(tool).id
    part["shape"] = {**mesh, "file": "gone.obj"}
    for send in (client.plan, ikplan.plan):
        with pytest.raises(InvalidRequest, match="cannot be read") as caught:
            send(document)
        assert caught.value.field == "scene.obstacles[0].shape.file"


def test_the_urdf_of_a_cell_can_be_sent(client: Client, tmp_path: Path) -> None:
    cell = tmp_path / "cell.urdf"
    cell.write_text(
        '<robot name="cell"><link name="world"><collision><origin xyz="0.6 0 -0.3"/>'
        '<geometry><box size="0.5 0.5 0.1"/></geometry></collision><collision>'
        '<origin xyz="0.6 0 -0.2"/><geometry><sphere radius="0.05"/></geometry></collision>'
        "</link></robot>"
    )
    scene = ikplan.read_scene(cell)
    assert client.plan(request(scene=scene)).id == ikplan.plan(request(scene=scene)).id


@pytest.mark.anyio
async def test_the_asynchronous_client_is_a_twin() -> None:
    scenes = MemoryDocumentStore(4, 2**20)
    alone = create_app(Settings(workers=1, store_path=":memory:"), scenes=scenes)
    async with AsyncClient(ADDRESS, transport=httpx.ASGITransport(alone)) as twin:
        scene_id = (await twin.upload_scene(SCENE, name="cell"))["id"]
        assert (await twin.scene(scene_id))["name"] == "cell"
        await twin.delete_scene(scene_id)
        with pytest.raises(InvalidRequest, match="no scene"):
            await twin.scene(scene_id)


@contextlib.asynccontextmanager
async def scene_store(path: Path) -> AsyncIterator[DocumentStore]:
    file = SqlitePlanStore(str(path), max_plans=9, max_bytes=10**6, max_age_s=3600.0)
    await file.open()
    yield SqliteDocumentStore(file, "scenes", 9, 10**6)
    await file.close()


@pytest.mark.anyio
async def test_scenes_outlive_the_service_also_in_a_file_that_is_older(tmp_path: Path) -> None:
    path, kept = tmp_path / "plans.sqlite", StoredDocument(b"{}", b"[]")
    async with scene_store(path) as store:
        await store.put("a", kept)
    async with scene_store(path) as store:
        assert await store.get("a") == kept
    with contextlib.closing(sqlite3.connect(path)) as file:
        file.execute("DROP TABLE scenes")
    async with scene_store(path) as store:
        assert await store.names() == []
        assert await store.put("a", kept)


def test_points_are_planned_beside_a_stored_scene(client: Client, http: httpx.Client) -> None:
    scene_id = client.upload_scene(wall([0.0, 0.1, 0.0]))["id"]
    row = ",".join(map(str, tool_at([0.0, 0.2, 0.0])))
    query = {"robot": "ur5", "units": "m", "interpolation": "line", "scene": scene_id}
    answer = http.post(
        "/v1/plans", params=query, content=f"x,y,z\n{row}\n", headers={"content-type": "text/csv"}
    )
    assert answer.status_code == 422
    assert "wall" in answer.json()["pair"], json.dumps(answer.json())
