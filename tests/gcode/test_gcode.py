"""G-code as a path: the moves of a program, what is refused, and plans along them."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ikplan
from ikplan import InvalidRequest, read_gcode
from ikplan.cli import main
from ikplan.gcode import read_toolpath
from ikplan.gcode.reading import path_of

HEAD = "G21 G90\nG0 X0 Y0 Z5\nF600\n"


def moves(text: str) -> list[tuple[np.ndarray, Any, float | None]]:
    return [(m.end * 1e3, m.arc, m.speed) for m in read_toolpath(text.encode()).moves]


def on_arc(start: np.ndarray, arc: Any, share: float) -> np.ndarray:
    """A place of an arc, by turning its start about its axis."""
    axis = np.eye(3)[arc.normal]
    a = start - arc.centre
    turned = arc.angle * share
    along = axis * (axis @ a)
    flat = a - along
    place = flat * math.cos(turned) + np.cross(axis, flat) * math.sin(turned)
    return np.asarray(arc.centre + along + place + axis * arc.rise * share)


def test_motions_are_modal_and_feeds_are_tool_speeds() -> None:
    found = moves(
        "%\n(a part)\nN10 G21 G0 X10 Y0 Z5\nN20 G1 Z-1 F300\nX20\nY7.5 F600 ; side\nG0 Z5\n"
    )
    ends: list[list[float]] = [[10, 0, -1], [20, 0, -1], [20, 7.5, -1], [20, 7.5, 5]]
    np.testing.assert_allclose([end for end, _, _ in found], ends, atol=1e-9)
    assert [speed for _, _, speed in found] == pytest.approx([0.005, 0.005, 0.01, None])


def test_inches_and_increments_give_the_same_path() -> None:
    metric = moves(HEAD + "G1 X25.4 Y50.8\nX0\n")
    inches = moves("g20g90\ng0x0y0z.19685039370\nf23.622047244\ng91\ng1 x1 y2\nx-1\n")
    for (end, _, speed), (same, _, other) in zip(metric, inches, strict=True):
        np.testing.assert_allclose(same, end, atol=1e-6)
        assert other == pytest.approx(speed)


@settings(deadline=None)
@given(
    st.floats(1.0, 50.0),
    st.floats(-3.1, 3.1),
    st.floats(0.05, 6.2),
    st.sampled_from([17, 18, 19]),
    st.booleans(),
    st.floats(-5.0, 5.0),
)
def test_arcs_by_centre_and_by_radius_are_the_circle(
    radius: float, first: float, angle: float, plane: int, clockwise: bool, rise: float
) -> None:
    a, b, normal = {17: (0, 1, 2), 18: (2, 0, 1), 19: (1, 2, 0)}[plane]
    sense = -1.0 if clockwise else 1.0
    centre = np.zeros(3)
    start, end = np.zeros(3), np.zeros(3)
    start[[a, b]] = radius * np.array([math.cos(first), math.sin(first)])
    last = first + sense * angle
    end[[a, b]] = radius * np.array([math.cos(last), math.sin(last)])
    end[normal] = rise
    names, offsets = "XYZ", "IJK"
    head = "G21 F600 G0 " + " ".join(f"{n}{v:.6f}" for n, v in zip(names, start, strict=True))
    to = " ".join(f"{n}{v:.6f}" for n, v in zip(names, end, strict=True))
    code = f"G{plane} G{2 if clockwise else 3} {to}"
    about = " ".join(f"{offsets[k]}{centre[k] - start[k]:.6f}" for k in (a, b))
    form = [f"{code} {about}", f"{code} R{(radius if angle <= math.pi else -radius):.6f}"]
    # Where half a turn is near, rounding decides which arc a radius means.
    for line in form if abs(angle - math.pi) > 0.1 else form[:1]:
        move = read_toolpath(f"{head}\n{line}\n".encode()).moves[-1]
        assert move.arc is not None
        assert move.arc.angle == pytest.approx(sense * angle, abs=1e-4)
        np.testing.assert_allclose(on_arc(start / 1e3, move.arc, 1.0), move.end, atol=1e-9)
        middle = on_arc(start / 1e3, move.arc, 0.5) * 1e3
        expected = np.zeros(3)
        half = first + sense * angle / 2.0
        expected[[a, b]] = radius * np.array([math.cos(half), math.sin(half)])
        expected[normal] = rise / 2.0
        np.testing.assert_allclose(middle, expected, atol=2e-2)


def test_a_whole_circle_and_centres_from_the_origin() -> None:
    circle = moves(HEAD + "G1 X10 Y0\nG2 I-10 J0\n")[-1][1]
    assert circle.angle == pytest.approx(-2.0 * math.pi)
    same = moves(HEAD + "G90.1 G1 X10 Y0\nG2 I0 J0\n")[-1][1]
    np.testing.assert_allclose(same.centre, circle.centre, atol=1e-12)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("G0 X1 Y2", "line 1: the file does not say its unit"),
        (HEAD + "G1 X1 A90", "line 4: axis A"),
        (HEAD + "G81 X1 Z-1 R1", "line 4: G81"),
        (HEAD + "G41 D1", "line 4: G41: a radius offset"),
        (HEAD + "#1=3", "line 4: parameters"),
        (HEAD + "G1 X1 X2", "line 4: X is given twice"),
        (HEAD + "G2 X1 Y1", "line 4: an arc has a centre"),
        (HEAD + "G2 X9 Y0 I3 J0", "from the centre"),
        (HEAD + "G2 X9 Y0 R1", "smaller than half"),
        (HEAD + "G2 X0 Y0 R1", "a whole circle has no radius form"),
        (HEAD + "G1 X1 (no end", "a comment that does not end"),
        (HEAD + "hello", "no word of G-code"),
        ("G21\nX1 Y1", "a place without a motion"),
        ("G21\nG1 X1 Y1", "no feed yet"),
        ("G21 F1\nG0 X0\nG2 X1 I0.5", "before X, Y and Z"),
        ("G21\nM3", "moves nothing"),
        ("G21\nG0 X1 Y1 Z1", "no place from which"),
        ("", "moves nothing"),
    ],
)
def test_what_is_not_read_is_refused_with_its_line(text: str, words: str) -> None:
    with pytest.raises(InvalidRequest, match=words):
        read_toolpath(text.encode())


@settings(deadline=None)
@given(st.binary(max_size=200))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    try:
        read_toolpath(data, "mm")
    except InvalidRequest:
        return


def test_what_is_passed_over_is_named() -> None:
    found = read_toolpath(b"G21 G54 S1000 M3\nG0 X0 Y0\nG1 X5 F60\nG4 P1\nM30\nG1 X9\n")
    assert len(found.moves) == 1
    assert found.notes == [
        "Z has no value: it is 0",
        "passed over: G54 (line 1), M3 (line 1), S (line 1), G4 (line 4)",
    ]


def test_a_helix_goes_through_points_of_it() -> None:
    text = HEAD + "G1 Z0\nG1 X10\nG3 X10 Y0 Z-2 I-10 J0\n"
    through = path_of(read_toolpath(text.encode()))["segments"][-1]["through"]
    points = np.array([pose["position"] for pose in through]) * 1e3
    np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), 10.0, atol=1e-9)
    turned = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    np.testing.assert_allclose(points[:, 2], -2.0 * turned / (2.0 * math.pi), atol=1e-9)


def outline(count: int) -> str:
    """A program of the kind that slicers and drawing tools write: short lines and arcs."""
    lines = ["G21 G90", "G0 Z5", "G0 X0 Y0", "G1 Z0 F1200"]
    for k in range(count):
        x, y = 4.0 * (k + 1), 10.0 * (k % 2)
        lines.append(f"G1 X{x - 2} Y{y}")
        lines.append(f"G{2 + k % 2} X{x} Y{y} I1 J0")
    return "\n".join([*lines, "G0 Z5", "M30"]) + "\n"


def test_a_program_is_planned_along_its_moves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "outline.nc"
    file.write_text(outline(6))
    path = read_gcode(file)
    request = {
        "robot": "xarm7",
        "start": "free",
        "path": {**path, "frame": {"position": [0.3, 0.0, 0.2]}},
        "scene": {"self_collision": False},
    }
    plan = ikplan.plan(request)
    assert plan.certificate.max_path_deviation is not None
    assert plan.certificate.max_path_deviation < 1e-4
    out = tmp_path / "plan.json"
    words = [str(file), "--robot", "xarm7", "--start", "free", "--frame", "0.3", "0", "0.2"]
    code = main(["plan", *words, "--set", "scene.self_collision=false", "-o", str(out)])
    assert code == 0
    assert json.loads(out.read_text())["id"] == plan.id
    assert "passed over" not in capsys.readouterr().err
    assert main(["plan", str(file), "--robot", "xarm7", "--columns", "x,y,z"]) == 2
