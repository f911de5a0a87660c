import ast
import csv
import io
import json
import re
import zipfile
from pathlib import Path

import numpy as np
import pytest

import ikplan.plans.export
from ikplan import InvalidRequest, Plan
from ikplan.documents.controller import LanguageInfo
from ikplan.plans.export import FORMATS, encode, format_for, save
from ikplan.plans.export.formats import Format

from .plans import CB3, rest_to_rest

NAMES = [
    "json",
    "csv",
    "npz",
    "ros",
    "ros-goal",
    "urscript",
    "rapid",
    "krl",
    "fanuc-ls",
    "drl",
    "xarm",
    "franky",
]
SUFFIXES = [
    *(".json", ".csv", ".npz", ".ros.json", ".goal.yaml", ".ros.yaml"),
    *(".script", ".mod", ".src", ".ls", ".drl", ".xarm.py", ".franky.py"),
]


def test_json_is_the_document_of_the_plan() -> None:
    plan = rest_to_rest()
    document = encode(plan, "json")
    assert document == plan.model_dump_json().encode()
    assert Plan.load(document).model_dump_json().encode() == document
    assert json.loads(document)["stats"]["ik_evaluations"] == 7


def test_csv_reads_back_exactly() -> None:
    plan = rest_to_rest(dof=3, samples=17)
    rows = list(csv.reader(io.StringIO(encode(plan, "csv").decode())))
    table = np.array([[float(cell) for cell in row] for row in rows[1:]])
    motion = plan.trajectory
    assert np.array_equal(table[:, 0], motion.time)
    assert np.array_equal(table[:, 1:4], motion.q)
    assert np.array_equal(table[:, 4:7], motion.dq)
    assert np.array_equal(table[:, 7:], motion.ddq)


def test_csv_header_names_joints_and_units() -> None:
    plan = rest_to_rest(dof=2, units=("rad", "m"))
    titles = next(csv.reader(io.StringIO(encode(plan, "csv").decode())))
    assert titles == [
        "time [s]",
        "q j1, the 1th [rad]",
        "q j2, the 2th [m]",
        "dq j1, the 1th [rad/s]",
        "dq j2, the 2th [m/s]",
        "ddq j1, the 1th [rad/s^2]",
        "ddq j2, the 2th [m/s^2]",
    ]


def test_npz_reads_back_without_pickle(tmp_path: Path) -> None:
    plan = rest_to_rest()
    save(plan, tmp_path / "plan.npz")
    with np.load(tmp_path / "plan.npz", allow_pickle=False) as arrays:
        assert str(arrays["id"]) == plan.id
        assert list(arrays["joint_names"]) == plan.joint_names
        assert np.array_equal(arrays["ddq"], plan.trajectory.ddq)
        assert np.array_equal(arrays["waypoint_q"], plan.waypoints.q)
        assert np.array_equal(arrays["waypoint_orientation_error"], [np.nan, 1e-8], equal_nan=True)
        certificate = json.loads(str(arrays["certificate"]))
    assert certificate == plan.certificate.model_dump(mode="json")


def test_npz_does_not_depend_on_memory_order_clock_or_cost() -> None:
    plan = rest_to_rest()
    motion = plan.trajectory
    fortran = motion.model_copy(update={"q": np.asfortranarray(motion.q)})
    other = plan.model_copy(
        update={
            "trajectory": fortran,
            "stats": plan.stats.model_copy(update={"ik_evaluations": 8}),
        }
    )
    assert encode(other, "npz") == encode(plan, "npz")
    with zipfile.ZipFile(io.BytesIO(encode(plan, "npz"))) as archive:
        assert {m.date_time for m in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}


@pytest.mark.parametrize("known", FORMATS, ids=lambda f: f.name)
def test_the_suffix_chooses_the_format(known: Format, tmp_path: Path) -> None:
    languages = [LanguageInfo(name=n, variant="any") for n in NAMES[5:]]
    controller = CB3.model_copy(update={"languages": languages, "jerk": [5000.0] * 7})
    dof, robot = (7, "fr3") if known.name == "franky" else (6, "abb_irb6640_185_280")
    plan = rest_to_rest(dof, 51, controller=controller).model_copy(update={"robot": robot})
    for suffix in known.suffixes:
        target = tmp_path / f"ikplan_trajectory{suffix.upper()}"
        plan.save(target)
        assert target.read_bytes() == known.encode(plan) == encode(plan, known.name)


def test_names_suffixes_and_media_types_are_unambiguous() -> None:
    for values in (
        [f.name for f in FORMATS],
        [s for f in FORMATS for s in f.suffixes],
        [f.media_type for f in FORMATS],
    ):
        assert len(set(values)) == len(values)


@pytest.mark.parametrize("name", ["plan.xlsx", "plan", "json", ".jsonx"])
def test_an_unknown_suffix_lists_the_formats_and_writes_nothing(name: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidRequest, match=re.escape(", ".join(SUFFIXES))) as caught:
        save(rest_to_rest(), tmp_path / name)
    assert caught.value.allowed == SUFFIXES
    assert not list(tmp_path.iterdir())
    with pytest.raises(InvalidRequest) as caught:
        encode(rest_to_rest(), "xlsx")
    assert caught.value.allowed == NAMES


def test_a_format_is_chosen_without_touching_the_disk() -> None:
    assert format_for("/no/such/folder/plan.CSV").name == "csv"


def test_formats_do_not_import_the_documents_they_write() -> None:
    for source in Path(ikplan.plans.export.__file__).parent.glob("*.py"):
        tree = ast.parse(source.read_text())
        at_run_time = [n for n in tree.body if isinstance(n, ast.ImportFrom)]
        assert "ikplan.plans.plan" not in {n.module for n in at_run_time}, source.name


def test_ros_messages_read_back_to_the_nanosecond() -> None:
    plan = rest_to_rest(3, 17, ("rad", "m", "rad"))
    message = json.loads(encode(plan, "ros"))
    assert list(message) == ["header", "joint_names", "points"]
    assert message["joint_names"] == plan.joint_names
    stamps = [p["time_from_start"] for p in message["points"]]
    time = np.array([s["sec"] + 1e-9 * s["nanosec"] for s in stamps])
    assert all(0 <= s["nanosec"] < 10**9 for s in stamps)
    assert stamps[-1]["sec"] == 1
    assert np.abs(time - plan.trajectory.time).max() <= 0.5e-9 + 1e-15
    for key, rows in (("positions", "q"), ("velocities", "dq"), ("accelerations", "ddq")):
        back = np.array([p[key] for p in message["points"]])
        assert np.array_equal(back, getattr(plan.trajectory, rows))


def test_a_name_chooses_the_format_whatever_the_suffix(tmp_path: Path) -> None:
    plan = rest_to_rest()
    plan.save(tmp_path / "plan.txt", format="csv")
    assert (tmp_path / "plan.txt").read_bytes() == encode(plan, "csv")
    with pytest.raises(InvalidRequest) as caught:
        plan.save(tmp_path / "plan.csv", format="xlsx")
    assert caught.value.field == "format"
