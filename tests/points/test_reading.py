"""Files of points: read right, or refused with what is wrong."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan import InvalidRequest
from ikplan.documents import parse
from ikplan.documents.path import PathRequest
from ikplan.points import JointName, Reading, read_points, read_waypoints

from .dialects import READ, REFUSED, Dialect


def as_bytes(text: str | bytes) -> bytes:
    return text if isinstance(text, bytes) else text.encode()


@pytest.mark.parametrize("dialect", READ, ids=lambda d: d.name)
def test_a_dialect_is_read_right(dialect: Dialect) -> None:
    points = read_points(as_bytes(dialect.text), Reading(**dialect.options))
    positions = [pose["position"] for pose in points.poses]
    np.testing.assert_allclose(positions, dialect.points, rtol=1e-14)
    rotations = dialect.rotations or [None] * len(positions)
    for pose, asked in zip(points.poses, rotations, strict=True):
        if asked is None:
            assert "quaternion_xyzw" not in pose
            continue
        R = pin.Quaternion(np.array(pose["quaternion_xyzw"])).matrix()
        if callable(asked):
            assert asked(R)
        else:
            np.testing.assert_allclose(R, asked, atol=1e-9)
    said = "\n".join(note.text for note in points.notes)
    for words in dialect.notes:
        assert words in said
    for name, value in {"free_axis": None, **dialect.expected}.items():
        assert getattr(points, name) == value
    parse(PathRequest, {"waypoints": points.poses})


@pytest.mark.parametrize(("text", "field", "words"), REFUSED)
def test_what_is_wrong_or_open_is_refused_with_its_place(text: str, field: str, words: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        read_points(text.encode())
    assert caught.value.field == field
    assert words in caught.value.detail
    if field.startswith("line"):
        assert field.partition(",")[0] in caught.value.detail


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"units": "ft"}, "units"),
        ({"angles": "grad"}, "angles"),
        ({"free_axis": "w"}, "free_axis"),
    ],
)
def test_an_option_has_choices(options: dict[str, str], field: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        Reading(**options)
    assert caught.value.field == field
    assert caught.value.allowed


def test_what_the_caller_says_must_fit_the_file() -> None:
    with pytest.raises(InvalidRequest, match="the header says") as caught:
        read_points(b"x_mm,y,z\n1,2,3\n", Reading(units="m"))
    assert caught.value.field == "units"
    with pytest.raises(InvalidRequest, match="free_axis"):
        read_points(b"x,y,z\n1,2,3\n", Reading(free_axis="z"))


def test_one_unit_in_the_header_counts_for_all_coordinates() -> None:
    points = read_points(b"x [mm],y,z\n1,2,3\n")
    np.testing.assert_allclose(points.poses[0]["position"], [0.001, 0.002, 0.003])
    assert not any(note.guessed for note in points.notes)


def test_a_file_is_read_and_what_was_guessed_is_warned_of(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    file = tmp_path / "points.csv"
    file.write_text("x,y,z\n565,-120,300\n")
    caplog.set_level(logging.INFO, logger="ikplan.points")
    assert ikplan.read_waypoints(file) == [{"position": [0.565, -0.12, 0.3]}]
    assert ikplan.read_waypoints(str(file), units="m") == [{"position": [565.0, -120.0, 300.0]}]
    (guess,) = [r for r in caplog.records if r.levelno == logging.WARNING]
    assert "millimetres" in guess.getMessage()


def test_a_file_that_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(InvalidRequest, match="missing") as caught:
        read_waypoints(tmp_path / "missing.csv")
    assert isinstance(caught.value.__cause__, FileNotFoundError)
    binary = tmp_path / "binary.csv"
    for data in (b"\x00\x01\x02\xff", b"\xff\xfe\x00"):
        binary.write_bytes(data)
        with pytest.raises(InvalidRequest, match="no text"):
            read_waypoints(binary)
    (tmp_path / "joints.csv").write_text("j1,j2\n0,1\n")
    with pytest.raises(InvalidRequest, match="joint values and no poses"):
        read_waypoints(tmp_path / "joints.csv")


def test_too_many_points_are_refused_where_they_become_too_many() -> None:
    with pytest.raises(InvalidRequest, match="more than 20000") as caught:
        read_points(b"x,y,z\n" + b"0,0,0\n" * 20_002)
    assert caught.value.field == "line 20002"


UR = tuple(
    JointName(name)
    for name in (
        "shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint",
        "wrist_1_joint", "wrist_2_joint", "wrist_3_joint",
    )
)  # fmt: skip
NAMES = [joint.name for joint in UR]


def test_joints_are_read_by_name_in_any_order() -> None:
    shuffled = [NAMES[k] for k in (3, 0, 5, 1, 4, 2)]
    text = "time," + ",".join(shuffled) + "\n0,3,0,5,1,4,2\n0.1,3.3,0.3,5.3,1.3,4.3,2.3\n"
    points = read_points(text.encode(), Reading(angles="rad"), UR)
    assert points.joints == [[0, 1, 2, 3, 4, 5], [0.3, 1.3, 2.3, 3.3, 4.3, 5.3]]
    assert points.timed
    assert not points.poses


@pytest.mark.parametrize(
    "header",
    [
        ",".join(f"/joint_states/{n}/position,/joint_states/{n}/velocity" for n in NAMES),
        ",".join(f"q {n} [deg],dq {n} [rad/s]" for n in NAMES),
        ",".join(f"{n}_deg,{n}_effort" for n in NAMES),
        ",".join(f"J{k} [°],v{k}" for k in range(1, 7)),
        ",".join(f"joint_{k},comment{k}" for k in range(6)),
        ",".join(f"{n.upper()},remark {n}" for n in NAMES),
    ],
)
def test_joints_are_read_under_the_names_that_programs_give_them(header: str) -> None:
    row = ",".join(f"{10 * k},99" for k in range(6))
    points = read_points(
        f"{header}\n{row}\n".encode(),
        Reading(angles="deg" if "deg" not in header and "°" not in header else None),
        UR,
    )
    np.testing.assert_allclose(points.joints, [np.radians([0, 10, 20, 30, 40, 50])], rtol=1e-14)


@pytest.mark.parametrize("robot", REFERENCE_ROBOTS)
@pytest.mark.parametrize("title", ["{}", "{} [{}]", "q {} [{}]", "{}_{}", "/states/{}/position"])
def test_the_joints_of_every_robot_are_known_by_their_names(robot: str, title: str) -> None:
    arm = ikplan.load_robot(robot)
    slides = arm.prismatic.tolist()
    joints = [JointName(n, s) for n, s in zip(arm.joint_names, slides, strict=True)]
    titles = [title.format(j.name, "m" if j.slides else "rad") for j in joints]
    order = [*range(arm.dof)][::-1]
    values = [round(0.1 * (k + 1), 3) for k in range(arm.dof)]
    text = ",".join(titles[k] for k in order) + "\n" + ",".join(str(values[k]) for k in order)
    assert read_points(text.encode(), joints=joints).joints == [values]


def test_a_comment_can_name_the_columns_and_need_not() -> None:
    text = "# recorded by hand\n# x (old) in y\n# j1 j2\n# of no use\n0.1 0.2\n"
    assert read_points(text.encode()).joints == [[0.1, 0.2]]
    assert read_points(b"# x (old) , y, z\n0.1,0.2,0.3\n").poses[0]["position"] == [0.1, 0.2, 0.3]


def test_joints_that_slide_have_lengths() -> None:
    joints = (JointName("lift", slides=True), JointName("turn"))
    points = read_points(b"turn,lift\n90,350\n-45,100\n", joints=joints)
    np.testing.assert_allclose(points.joints, [[0.35, np.pi / 2], [0.1, -np.pi / 4]])
    said = [note.text for note in points.notes]
    assert any("millimetres" in text for text in said)
    assert any("degrees" in text for text in said)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("j1,j2,j3\n0,0,0\n", "wrist_1_joint"),
        (",".join(NAMES[:5]) + "\n0,0,0,0,0\n", "wrist_3_joint is missing"),
        (",".join(f"j{k}" for k in range(1, 9)) + "\n" + "0," * 7 + "0\n", "the file 8"),
        (",".join(f"q {n}x" for n in NAMES) + "\n0,0,0,0,0,0\n", "did you mean"),
        (",".join(f"j{k} [mm]" for k in range(1, 7)) + "\n0,0,0,0,0,0\n", "the joint turns"),
        (",".join(f"j{k}" for k in range(1, 7)) + "\n0,0,0,0,0,5\n", "radians or degrees"),
    ],
)
def test_joint_values_that_fit_no_robot_are_refused(text: str, words: str) -> None:
    with pytest.raises(InvalidRequest) as caught:
        read_points(text.encode(), joints=UR)
    assert words in caught.value.detail
