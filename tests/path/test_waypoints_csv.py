"""Waypoints from CSV."""

import csv
import io
import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from ikplan import InvalidRequest
from ikplan.documents import parse
from ikplan.path import read_waypoints_csv
from ikplan.request import PathRequest

from .requests import random_poses, seeds


def written(poses) -> str:
    text = io.StringIO()
    writer = csv.writer(text)
    writer.writerow(["x", "y", "z", "qx", "qy", "qz", "qw"])
    for pose in poses:
        writer.writerow([*pose["position"], *pose.get("quaternion_xyzw", [""] * 4)])
    return text.getvalue()


@settings(max_examples=25, deadline=None)
@given(seeds, st.integers(1, 8), st.booleans())
def test_what_is_written_is_read_again(seed, count, oriented):
    poses = random_poses(seed, count, oriented=oriented)
    if count > 2:
        poses[1].pop("quaternion_xyzw", None)
    read = read_waypoints_csv(written(poses))
    assert [set(p) for p in read] == [set(p) for p in poses]
    asked = parse(PathRequest, {"waypoints": poses}).waypoints
    assert parse(PathRequest, {"waypoints": read}).waypoints == asked


def test_a_file_is_read_like_its_text(tmp_path):
    text = "\ufeff# made by hand\n\nx;y;z\n0.1;0.2;0.3\n# between\n1;2;3\n"
    file = tmp_path / "points.csv"
    file.write_text(text, encoding="utf-8")
    wanted = [{"position": [0.1, 0.2, 0.3]}, {"position": [1.0, 2.0, 3.0]}]
    assert read_waypoints_csv(file) == wanted
    assert read_waypoints_csv(str(file)) == wanted
    assert read_waypoints_csv(text) == wanted


@settings(max_examples=30, deadline=None)
@given(*[st.floats(-180.0, 180.0)] * 3)
def test_roll_pitch_and_yaw_turn_about_fixed_axes_in_their_units(roll, pitch, yaw):
    text = f"yaw_deg,pitch [deg],roll (DEG),z_mm,y [cm],x\n{yaw!r},{pitch!r},{roll!r},30,2,0.1\n"
    (waypoint,) = read_waypoints_csv(text.replace("DEG", "deg"))
    assert_allclose(waypoint["position"], [0.1, 0.02, 0.03], rtol=1e-14)
    wanted = Rotation.from_euler("xyz", [roll, pitch, yaw], degrees=True)
    assert_allclose(
        Rotation.from_quat(waypoint["quaternion_xyzw"]).as_matrix(), wanted.as_matrix(), atol=1e-12
    )
    angles = ",".join(repr(math.radians(a)) for a in (roll, pitch, yaw))
    (same,) = read_waypoints_csv(f"x,y,z,roll,pitch,yaw\n0,0,0,{angles}\n")
    assert abs(np.dot(same["quaternion_xyzw"], waypoint["quaternion_xyzw"])) > 1.0 - 1e-12


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("x,y\n1,2\n", 1, "make no pose"),
        ("x,y,z,qx,qy\n1,2,3,4,5\n", 1, "make no pose"),
        ("x,y,z,qx,qy,qz,qw,yaw\n", 1, "make no pose"),
        ("x,y,x\n1,2,3\n", 1, "twice"),
        ("x,y,z,speed\n1,2,3,4\n", 1, "unknown column 'speed'"),
        ("x,y,z,rol,pitch,yaw\n", 1, "did you mean 'roll'"),
        ("1,2,3\n4,5,6\n", 1, "unknown column '1'"),
        ("x [ft],y,z\n1,2,3\n", 1, "unit 'ft'"),
        ("x,y,z,qx [rad],qy,qz,qw\n", 1, "unit 'rad'"),
        ("x,y,z\n", 1, "no waypoint"),
        ("\n", 1, "make no pose"),
        ("x,y,z\n1,2,3\n\n1,2\n", 4, "2 values for 3 columns"),
        ("x,y,z\n1,2,three\n", 2, "'three' in column 'z'"),
        ("x,y,z\n1,2,\n", 2, "column 'z'"),
        ("x,y,z\n1,nan,3\n", 2, "'nan' in column 'y'"),
        ("x,y,z\n1,1e999,3\n", 2, "'1e999' in column 'y'"),
        ("# c\nx,y,z,qx,qy,qz,qw\n1,2,3,0,0,0,1\n1,2,3,0,0,0,2\n", 4, "norm 2"),
        ("x,y,z,qx,qy,qz,qw\n1,2,3,0,,0,1\n", 2, "'' in column 'qy'"),
    ],
)
def test_a_wrong_line_is_named(text, line, words):
    with pytest.raises(InvalidRequest) as caught:
        read_waypoints_csv(text)
    assert caught.value.field == f"line {line}"
    assert words in caught.value.detail
    assert caught.value.detail.startswith(f"line {line}: ")


def test_a_file_that_cannot_be_read_is_named(tmp_path):
    with pytest.raises(InvalidRequest, match="missing") as caught:
        read_waypoints_csv(tmp_path / "missing.csv")
    assert isinstance(caught.value.__cause__, FileNotFoundError)
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InvalidRequest, match="binary"):
        read_waypoints_csv(binary)


def test_too_many_waypoints_are_refused_where_they_become_too_many():
    with pytest.raises(InvalidRequest, match="more than 10000") as caught:
        read_waypoints_csv("x,y,z\n" + "0,0,0\n" * 10_002)
    assert caught.value.field == "line 10002"
