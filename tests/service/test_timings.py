"""Joint paths timed in Python, in the shell, over HTTP and by the clients: one verdict."""

import asyncio
import copy
import io
import json
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import AsyncClient, Client, InvalidRequest, Plan, RobotNotFound, TimingFailed
from ikplan.cli import main
from ikplan.errors import IkplanError, error_from_problem
from ikplan_api.app import create_app
from ikplan_api.settings import Settings

from .bad_requests import GOOD as GOOD_PLAN
from .conftest import ADDRESS

GOOD: dict[str, Any] = {
    "robot": "ur5",
    "waypoints": [
        [0.0, -1.57, 1.57, 0.0, 1.0, 0.0],
        [0.4, -1.2, 1.3, 0.1, 1.0, 0.2],
        [0.8, -1.4, 1.6, 0.0, 1.0, 0.0],
    ],
    "limits": {"tool_speed": 0.5, "jerk": 200.0},
    "sampling": {"rate_hz": 125, "form": "polynomial"},
}


def without_stats(plan: Plan) -> dict[str, Any]:
    return plan.model_dump(mode="json", exclude={"stats"})


def test_every_way_gives_the_same_trajectory(
    http: httpx.Client, client: Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    here = ikplan.time_request(GOOD)
    assert without_stats(client.time(GOOD)) == without_stats(here)
    assert without_stats(client.time({**GOOD, "waypoints": np.array(GOOD["waypoints"])})) == (
        without_stats(here)
    )
    assert without_stats(client.get_plan(here.id)) == without_stats(here)
    answer = http.post("/v1/timings", json=GOOD)
    assert answer.headers["content-location"] == f"/v1/plans/{here.id}"
    file = tmp_path / "request.json"
    file.write_text(json.dumps(GOOD))
    assert main(["time", str(file), "--json"]) == 0
    assert without_stats(Plan.load(capsys.readouterr().out)) == without_stats(here)


def test_the_asynchronous_client_is_a_twin() -> None:
    app = create_app(Settings(workers=1))

    async def ask() -> Plan:
        async with (
            app.router.lifespan_context(app),
            AsyncClient(ADDRESS, transport=httpx.ASGITransport(app)) as client,
        ):
            return await client.time(GOOD)

    assert without_stats(asyncio.run(ask())) == without_stats(ikplan.time_request(GOOD))


def test_the_shell_times_joint_values_and_trajectories_of_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = tmp_path / "rows.json"
    rows.write_text(json.dumps(GOOD["waypoints"]))
    table = tmp_path / "plan.csv"
    assert main(["time", "ur5", str(rows), "--rate", "125", "-o", str(table)]) == 0
    assert "binding: " in capsys.readouterr().out
    assert main(["time", "ur5", str(table), "--scale", "0.5", "--json"]) == 0
    again = Plan.load(capsys.readouterr().out)
    first = ikplan.time_path(ikplan.load_robot("ur5"), GOOD["waypoints"], rate_hz=125)
    assert np.array_equal(again.waypoints.q, first.q)
    assert again.duration > 1.3 * first.duration


def changed(*path: str | int, to: object) -> dict[str, Any]:
    document = copy.deepcopy(GOOD)
    place: Any = document
    for key in path[:-1]:
        place = place.setdefault(key, {}) if isinstance(place, dict) else place[key]
    place[path[-1]] = to
    return document


BAD: list[tuple[dict[str, Any], type[IkplanError], str, str]] = [
    (changed("limits", "velocity", to=0.0), InvalidRequest, "limits.velocity", "greater"),
    (changed("limits", "velocity", to=[1.0, -1.0, 1, 1, 1, 1]), InvalidRequest,
     "limits.velocity[1]", "greater"),
    (changed("limits", "acceleration", to=-2.0), InvalidRequest, "limits.acceleration", "greater"),
    (changed("limits", "velocity_lower", to=0.5), InvalidRequest, "limits.velocity_lower", "less"),
    (changed("limits", "jerk", to=0), InvalidRequest, "limits.jerk", "greater"),
    (changed("limits", "jerk", to=[1.0] * 5), InvalidRequest, "limits.jerk", "6 values"),
    (changed("limits", "velocity", to=[1.0] * 7), InvalidRequest, "limits.velocity", "6 values"),
    (changed("limits", "tool_speed", to=0.0), InvalidRequest, "limits.tool_speed", "greater"),
    (changed("limits", "tool_speed", to={"linear": -1.0}), InvalidRequest,
     "limits.tool_speed.linear", "greater"),
    (changed("limits", "tool_speed", to={"lineal": 1.0}), InvalidRequest,
     "limits.tool_speed.lineal", "linear"),
    (changed("limits", "tool_acceleration", to="fast"), InvalidRequest,
     "limits.tool_acceleration", "number"),
    (changed("limits", "torque", to="yes"), InvalidRequest, "limits.torque", "boolean"),
    (changed("limits", "torque", to=[0.0] * 6), InvalidRequest, "limits.torque[0]", "greater"),
    (changed("limits", "torque", to=[1.0] * 3), InvalidRequest, "limits.torque", "6 values"),
    (changed("limits", "payload", to={"mass": 1.0}), InvalidRequest, "limits.payload", "torque"),
    (changed("limits", to={"torque": True, "payload": {"mass": -1.0}}), InvalidRequest,
     "limits.payload.mass", "greater"),
    (changed("limits", to={"torque": True, "payload": {"mass": 900.0}}), TimingFailed, "",
     "stand still"),
    (changed("limits", "jerc", to=1.0), InvalidRequest, "limits.jerc", "jerk"),
    (changed("sampling", "rate_hz", to=10_001), InvalidRequest, "sampling.rate_hz", "10000"),
    (changed("sampling", "form", to="splines"), InvalidRequest, "sampling.form", "polynomial"),
    (changed("waypoints", 1, 2, to=9.0), InvalidRequest, "waypoints[1][2]", "outside"),
    (changed("waypoints", 2, to=[0.0] * 5), InvalidRequest, "waypoints[2]", "6 values"),
    (changed("waypoints", to=[]), InvalidRequest, "waypoints", "at least 1"),
    (changed("rest_at", to=[3]), InvalidRequest, "rest_at", "no waypoint 3"),
    (changed("segments", to=[{"first": 0, "last": 2, "limits": {"tool_speed": -1.0}}]),
     InvalidRequest, "segments[0].limits.tool_speed", "greater"),
    (changed("segments", to=[{"first": 0, "last": 3, "limits": {}}]), InvalidRequest,
     "segments[0].last", "no waypoint 3"),
    (changed("segments", to=[{"first": 0, "last": 2, "limits": {"velocity": [1.0] * 7}}]),
     InvalidRequest, "segments[0].limits.velocity", "6 values"),
    (changed("robot", to="ur6"), RobotNotFound, "", "ur5"),
    (changed("robot", to="/etc/passwd"), RobotNotFound, "", "passwd"),
    ({**changed("limits", to={"torque": True}), "robot": "mh5"}, InvalidRequest, "limits.torque",
     "inertias"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("document", "kind", "field", "word"),
    BAD,
    ids=[f"{b[2] or b[1].__name__}: {b[3]}" for b in BAD],
)
def test_a_wrong_timing_has_one_verdict(
    document: dict[str, Any],
    kind: type[IkplanError],
    field: str,
    word: str,
    http: httpx.Client,
    client: Client,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(kind) as caught:
        ikplan.time_request(document)
    error = caught.value
    assert word in error.detail
    if field:
        assert isinstance(error, InvalidRequest)
        assert error.field == field
    problem = http.post("/v1/timings", json=document)
    assert problem.headers["content-type"] == "application/problem+json"
    told = error_from_problem(problem.json())
    assert told.to_problem() == json.loads(json.dumps(error.to_problem()))
    with pytest.raises(kind) as caught:
        client.time(document)
    assert caught.value.data == told.data
    capsys.readouterr()
    body = io.TextIOWrapper(io.BytesIO(json.dumps(document).encode()))
    monkeypatch.setattr("sys.stdin", body)
    assert main(["time", "-"]) == (1 if isinstance(error, TimingFailed) else 2)
    line, *repairs = capsys.readouterr().err.splitlines()
    assert line == f"ikplan: {error.slug}: {' '.join(error.detail.split())}"
    assert len(repairs) == (len(error.data["repairs"]) + 1 if error.data.get("repairs") else 0)


@pytest.mark.parametrize(
    ("limits", "field"),
    [
        ({"velocity": [1.0] * 6}, "limits.velocity"),
        ({"jerk": -1.0}, "limits.jerk"),
        ({"torque": True}, "limits.torque"),
        ({"tool_speed": {"angular": 0.0}}, "limits.tool_speed.angular"),
    ],
)
def test_a_plan_names_the_wrong_limit(limits: dict[str, Any], field: str, client: Client) -> None:
    document = {**GOOD_PLAN, "limits": limits}
    with pytest.raises(InvalidRequest) as here:
        ikplan.plan(document)
    assert here.value.field == field
    with pytest.raises(InvalidRequest) as there:
        client.plan(document)
    assert there.value.data == here.value.data


@pytest.mark.parametrize(
    "arguments", [["time"], ["time", "rows.json"], ["time", "ur5", "request.json"]]
)
def test_a_wrong_command_is_told_in_one_line(
    arguments: list[str],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rows.json").write_text("[[0, 0, 0, 0, 0, 0]]")
    (tmp_path / "request.json").write_text(json.dumps(GOOD))
    assert main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("ikplan: invalid-request: ")


def test_a_table_that_is_none_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "rows.csv").write_text("1,2,three,4,5,6\n")
    assert main(["time", "ur5", str(tmp_path / "rows.csv")]) == 2
    assert "three" in capsys.readouterr().err
