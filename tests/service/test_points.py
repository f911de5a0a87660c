"""Files of points over HTTP."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest

import ikplan
from ikplan import Client
from ikplan.cli import main

from .urdfs import chain

CSV = {"content-type": "text/csv"}
POINTS = "x,y,z,rx,ry,rz\n400,-100,300,3.1415927,0,0\n400,100,300,3.1415927,0,0\n"


def post(http: httpx.Client, path: str, content: str | bytes, **query: Any) -> httpx.Response:
    return http.post(path, content=content, headers=CSV, params=query)


def test_a_file_is_planned_as_the_request_that_it_is_read_as(
    http: httpx.Client, tmp_path: Path
) -> None:
    query: dict[str, Any] = {
        "robot": "ur5", "interpolation": "line", "start": "free", "rate_hz": 125,
        "tool": "0,0,0.1,0,0,0", "base_frame": "base", "tool_speed": 0.2,
    }  # fmt: skip
    answer = post(http, "/v1/plans", POINTS, **query)
    assert answer.status_code == 200, answer.text
    assert "lengths read as millimetres" in answer.headers["ikplan-notes"]
    read = post(http, "/v1/points", POINTS, **query).json()
    assert ikplan.plan(read["request"]).id == answer.json()["id"]
    assert {"text", "guessed"} == set(read["notes"][0])
    file = tmp_path / "points.csv"
    file.write_text(POINTS)
    assert read["request"]["path"]["waypoints"] == ikplan.read_waypoints(file)
    assert read["request"]["limits"] == {"tool_speed": 0.2}
    frame = read["request"]["path"]["frame"]
    np.testing.assert_allclose(np.abs(frame["quaternion_xyzw"]), [0, 0, 1, 0], atol=1e-12)
    later = http.post(
        "/v1/plans", content=POINTS, params=query, headers={**CSV, "prefer": "respond-async"}
    )
    assert later.status_code in (200, 202)
    assert "ikplan-notes" in later.headers
    headers = {**CSV, "accept": "text/x-urscript"}
    program = http.post("/v1/plans", content=POINTS, params=query, headers=headers)
    assert program.text.startswith("def ")


@pytest.mark.parametrize(
    ("query", "content", "field"),
    [
        ({}, POINTS, "robot"),
        ({"robot": "ur5", "unit": "mm"}, POINTS, "unit"),
        ({"robot": "ur5", "units": "ft"}, POINTS, "units"),
        ({"robot": "ur5", "start": "1,2,x"}, POINTS, "start"),
        ({"robot": "ur5", "frame": "1,2"}, POINTS, "frame"),
        ({"robot": "ur5", "tool": "0,0,nan"}, POINTS, "tool"),
        ({"robot": "ur5", "interpolation": "arc"}, POINTS, "interpolation"),
        ({"robot": "ur5", "approach": "jump"}, POINTS, "approach"),
        ({"robot": "ur5", "rate_hz": "fast"}, POINTS, "rate_hz"),
        ({"robot": "ur5", "rate_hz": "0.1"}, POINTS, "sampling.rate_hz"),
        ({"robot": "ur5", "base_frame": "bse"}, POINTS, "base_frame"),
        ({"robot": "ur5"}, "x,y,z\n0.4,0,zero\n", "line 2, column z"),
        ({"robot": "ur5"}, "0.4,0,0.3,0,0,0,1\n", "columns"),
        ({"robot": "ur5"}, "x,y,z\n4,0,3\n", "units"),
        ({"robot": "ur5"}, "", "line 1"),
        ({"robot": "ur5"}, b"\x00\x01", ""),
        ({"robot": "ur5"}, "j1,j2\n0,0\n", "line 1"),
    ],
)
@pytest.mark.parametrize("path", ["/v1/plans", "/v1/points"])
def test_what_is_wrong_is_a_problem_with_its_field(
    path: str, query: dict[str, str], content: str | bytes, field: str, http: httpx.Client
) -> None:
    answer = post(http, path, content, **query)
    assert answer.status_code == 422
    problem = answer.json()
    assert problem["type"] == "urn:ikplan:invalid-request"
    assert problem["field"] == field


def test_a_robot_that_is_not_there_is_named(http: httpx.Client) -> None:
    answer = post(http, "/v1/plans", POINTS, robot="ur7")
    assert answer.status_code == 404
    assert "ur5" in answer.json()["near"]


def test_a_verdict_tells_how_the_file_was_read(http: httpx.Client) -> None:
    answer = post(http, "/v1/plans", POINTS, robot="ur5", units="m")
    assert answer.status_code == 422
    assert "are the coordinates millimetres?" in answer.json()["detail"]
    assert answer.json()["repairs"][0]["detail"] == "read the coordinates as millimetres"
    assert "rotation vector" in answer.headers["ikplan-notes"]


def test_the_query_is_for_files_of_points_only(http: httpx.Client) -> None:
    document = {"robot": "ur5", "path": {"waypoints": [{"position": [0.4, 0.0, 0.4]}]}}
    answer = http.post("/v1/plans", json=document, params={"units": "mm"})
    assert (answer.status_code, answer.json()["field"]) == (422, "units")
    assert http.post("/v1/plans", content=POINTS).status_code == 415
    assert http.post("/v1/timings", content=POINTS, headers=CSV).status_code == 415
    assert http.post("/v1/points", json=document).status_code == 415


def test_titles_of_columns_do_no_harm_in_a_header(http: httpx.Client) -> None:
    text = "x,y,z,na\u00efve\u2028\x85name\n0.4,0.1,0.4,1\n"
    answer = post(http, "/v1/plans", text, robot="ur5")
    assert answer.status_code in (200, 422)
    assert all(c.isprintable() for c in answer.headers.get("ikplan-notes", ""))


def test_joints_of_an_uploaded_robot_are_known_by_name(http: httpx.Client, client: Client) -> None:
    robot = client.upload_robot(chain(2))
    names = [joint["name"] for joint in robot["joints"]]
    text = f"{names[1]},{names[0]}\n0.1,0.2\n0.3,0.4\n"
    answer = post(http, "/v1/points", text, robot=robot["name"])
    assert answer.status_code == 200, answer.text
    segments = answer.json()["request"]["path"]["segments"]
    assert [s["q"] for s in segments] == [[0.2, 0.1], [0.4, 0.3]]
    refused = post(http, "/v1/points", POINTS, robot=robot["name"], base_frame="base")
    assert refused.json()["field"] == "base_frame"


def test_the_shell_reads_a_file_and_lets_a_service_plan(
    client: Client, live_address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    points, joints = tmp_path / "points.csv", tmp_path / "joints.csv"
    points.write_text(POINTS)
    options = ["--robot", "ur5", "--server", live_address, "--json"]
    assert main(["plan", str(points), *options]) == 0
    request = {"robot": "ur5", "path": {"waypoints": ikplan.read_waypoints(points)}}
    assert ikplan.Plan.load(capsys.readouterr().out).id == ikplan.plan(request).id
    # Of an uploaded robot the service knows the joints.
    robot = client.upload_robot(chain(2))
    joints.write_text("j2 [deg],j1 [deg]\n0,0\n30,60\n")
    options = ["--robot", robot["name"], "--server", live_address]
    assert main(["plan", str(joints), *options, "-q", "-o", "-"]) == 0
    plan = ikplan.Plan.load(capsys.readouterr().out)
    np.testing.assert_allclose(plan.waypoints.q[-1], np.radians([60, 30]))
    assert main(["plan", str(joints), *options, "-o", str(tmp_path / "x.script")]) == 2
    assert "URScript" in capsys.readouterr().err
    refused = ["plan", str(points), "--robot", "ur5", "--server", live_address, "--units", "m"]
    assert main(refused) == 1
    assert "repair 1: read the coordinates as millimetres" in capsys.readouterr().err


def test_the_document_tells_of_both_bodies(http: httpx.Client) -> None:
    document = http.get("/openapi.json").json()
    plan = document["paths"]["/v1/plans"]["post"]
    assert set(plan["requestBody"]["content"]) == {
        "application/json",
        "text/csv",
        "text/x-gcode",
    }
    named = {parameter["name"] for parameter in plan["parameters"]}
    assert "Ikplan-Notes" in plan["responses"]["200"]["headers"]
    assert {"robot", "units", "columns", "interpolation", "Prefer"} <= named
    assert json.loads(http.get("/openapi.json").content) == document


GCODE = "%\nG21 G90 G17\nG0 X0 Y0 Z20\nG1 Z0 F1200\nX40\nG2 X60 Y-20 R20 M3\nG1 Y-60\n%\n"


def test_a_gcode_file_is_planned_as_the_shell_reads_it(
    http: httpx.Client, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    headers = {"content-type": "text/x-gcode"}
    query: dict[str, Any] = {
        "robot": "xarm7",
        "start": "free",
        "frame": "0.35,0.05,0.25",
        "rate_hz": 125,
    }
    answer = http.post("/v1/plans", content=GCODE, params=query, headers=headers)
    assert answer.status_code == 200, answer.text
    assert answer.headers["ikplan-notes"] == "passed over: M3 (line 6)"
    file = tmp_path / "part.nc"
    file.write_text(GCODE)
    words = ["plan", str(file), "--robot", "xarm7", "--start", "free", "--rate", "125"]
    assert main([*words, "--frame", "0.35", "0.05", "0.25", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["id"] == answer.json()["id"]
    read = http.post("/v1/points", content=GCODE, params=query, headers=headers).json()
    assert ikplan.plan(read["request"]).id == answer.json()["id"]
    headers["accept"] = "text/x-python-xarm"
    program = http.post("/v1/plans", content=GCODE, params=query, headers=headers)
    assert "set_servo_angle_j" in program.text


@pytest.mark.parametrize(
    ("query", "content", "words"),
    [
        ({}, GCODE, "robot"),
        ({"robot": "xarm7", "interpolation": "line"}, GCODE, "does not go with G-code"),
        ({"robot": "xarm7"}, "G0 X0 Y0 Z0\nG1 X10", "G20"),
        ({"robot": "xarm7"}, "G21 G41 X0", "line 1"),
        ({"robot": "xarm7", "free_axis": "w"}, GCODE, "free"),
    ],
)
def test_what_is_wrong_with_gcode_is_said(
    query: dict[str, str], content: str, words: str, http: httpx.Client
) -> None:
    answer = http.post(
        "/v1/points", content=content, params=query, headers={"content-type": "text/x-gcode"}
    )
    assert answer.status_code == 422
    assert words in answer.text
