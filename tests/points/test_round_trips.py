"""Random poses written in each dialect are read as the same poses."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from ikplan import InvalidRequest
from ikplan.points import Reading, read_points

Array = NDArray[np.float64]
Write = Callable[[Array], Sequence[float]]

seeds = st.integers(0, 2**32 - 1)


def xyzw(R: Array) -> Sequence[float]:
    return [float(c) for c in pin.Quaternion(R).coeffs()]


def fixed(R: Array) -> Sequence[float]:
    """Roll, pitch, yaw [rad]."""
    return [float(c) for c in pin.rpy.matrixToRpy(R)]


def degrees(values: Sequence[float]) -> Sequence[float]:
    return [math.degrees(v) for v in values]


CONVENTIONS: dict[str, tuple[Sequence[str], Write]] = {
    "quaternion": (("qx", "qy", "qz", "qw"), xyzw),
    "scalar first": (("qw", "qx", "qy", "qz"), lambda R: [xyzw(R)[3], *xyzw(R)[:3]]),
    "ABB": (("q1", "q2", "q3", "q4"), lambda R: [xyzw(R)[3], *xyzw(R)[:3]]),
    "q0 to q3": (("q0", "q1", "q2", "q3"), lambda R: [xyzw(R)[3], *xyzw(R)[:3]]),
    "rotation vector": (("rx", "ry", "rz"), lambda R: [float(c) for c in pin.log3(R)]),
    "KUKA": (("A", "B", "C"), lambda R: degrees(fixed(R))[::-1]),
    "FANUC": (("W", "P", "R"), lambda R: degrees(fixed(R))),
    "degrees": (("roll [deg]", "pitch [deg]", "yaw [deg]"), lambda R: degrees(fixed(R))),
    "radians": (("roll_rad", "pitch_rad", "yaw_rad"), fixed),
    "none": ((), lambda _: []),
}
LENGTHS = {"m": 1.0, "mm": 1e-3, "in": 0.0254}


def written(
    rows: Sequence[Sequence[float]], titles: Sequence[str], separator: str, comma: bool
) -> bytes:
    text = io.StringIO()
    writer = csv.writer(text, delimiter=separator)
    writer.writerow(titles)
    for row in rows:
        cells = [repr(v) for v in row]
        writer.writerow([c.replace(".", ",") for c in cells] if comma else cells)
    return text.getvalue().encode()


def random_poses(seed: int, count: int) -> list[tuple[Array, Array]]:
    rng = np.random.default_rng(seed)
    poses = []
    for _ in range(count):
        axis = rng.normal(size=3)
        angle = rng.choice([0.0, 1e-9, 0.5, math.pi - 1e-6, math.pi]) + rng.uniform(0, 1e-3)
        rotvec = axis / np.linalg.norm(axis) * min(angle, math.pi)
        poses.append((pin.exp3(rotvec), rng.uniform(-2.0, 2.0, 3)))
    return poses


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("separator", [",", ";", "\t", " "])
@settings(max_examples=12, deadline=None)
@given(seeds, st.sampled_from(sorted(LENGTHS)), st.booleans(), st.randoms(use_true_random=False))
def test_poses_written_in_a_dialect_are_read_again(
    convention: str, separator: str, seed: int, unit: str, comma: bool, shuffle: Any
) -> None:
    names, write = CONVENTIONS[convention]
    poses = random_poses(seed, 5)
    titles = [f"x [{unit}]", f"y [{unit}]", f"z [{unit}]", *names, "id"]
    rows = [[*(p / LENGTHS[unit]).tolist(), *write(R), k + 0.5] for k, (R, p) in enumerate(poses)]
    if separator != " ":
        order = [*range(len(titles))]
        shuffle.shuffle(order)
        titles = [titles[k] for k in order]
        rows = [[row[k] for k in order] for row in rows]
    data = written(rows, titles, separator, comma)
    if separator == " ":
        data = data.replace(b'"', b"")
    read = read_points(data).poses
    for (R, p), pose in zip(poses, read, strict=True):
        np.testing.assert_allclose(pose["position"], p, rtol=0, atol=1e-12)
        if not names:
            assert "quaternion_xyzw" not in pose
            continue
        made = pin.Quaternion(np.array(pose["quaternion_xyzw"])).matrix()
        np.testing.assert_allclose(made, R, rtol=0, atol=1e-9)


@settings(max_examples=60, deadline=None)
@given(seeds, st.sampled_from(["x", "y", "z", "-x", "-y", "-z"]))
def test_a_tool_axis_points_where_the_file_says_and_turns_least_on_the_way(
    seed: int, axis: str
) -> None:
    rng = np.random.default_rng(seed)
    directions = rng.normal(size=(6, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    directions[3] = -directions[2]  # the one turn that has no shortest axis
    rows = [[0.1 * k, 0.0, 0.2, *v] for k, v in enumerate(directions.tolist())]
    data = written(rows, ["x", "y", "z", "i", "j", "k"], ",", False)
    points = read_points(data, Reading(free_axis=axis))
    assert points.free_axis == f"tool_{axis[-1]}"
    column, sign = "xyz".index(axis[-1]), -1.0 if axis.startswith("-") else 1.0
    turned = [pin.Quaternion(np.array(p["quaternion_xyzw"])).matrix() for p in points.poses]
    for R, v in zip(turned, directions, strict=True):
        np.testing.assert_allclose(sign * R[:, column], v, atol=1e-9)
    for a, b, u, v in zip(turned, turned[1:], directions, directions[1:], strict=False):
        between = math.atan2(np.linalg.norm(np.cross(u, v)), u @ v)
        assert np.linalg.norm(pin.log3(a.T @ b)) == pytest.approx(between, abs=1e-6)


@pytest.mark.parametrize(
    "text",
    [
        "x,y,z\n1,2,3" + "," * 1_000_000 + "4",
        "x y z\n" + "1" * 1_000_000 + " 2 3",
        "x" + "_m" * 100_000 + ",y,z\n1,2,3",
        "[" * 100_000 + ",y,z\n1,2,3",
        "1 " * 200_000,
        ";" * 1_000_000 + "x",
        "# x" * 100_000,
    ],
)
def test_files_made_to_take_long_are_refused_in_few_words(text: str) -> None:
    with pytest.raises(InvalidRequest) as caught:  # in minutes, were the work quadratic
        read_points(text.encode(), Reading(units="m"))
    assert len(caught.value.detail) < 400


def test_cells_of_nothing_beyond_the_last_column_are_no_values() -> None:
    # In minutes, were the work quadratic.
    (pose,) = read_points(b"x,y,z\n1,2,3" + b"," * 1_000_000).poses
    assert pose["position"] == [1.0, 2.0, 3.0]


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=200) | st.text("xyzqwijk0123456789.,;\t \n[]mdeg-+e\"'#", max_size=120))
def test_no_file_breaks_the_reader(data: bytes | str) -> None:
    try:
        points = read_points(data if isinstance(data, bytes) else data.encode())
    except InvalidRequest:
        return
    assert points.poses or points.joints
