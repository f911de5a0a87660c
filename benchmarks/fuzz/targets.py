"""What is fuzzed: every reader of the service that takes bytes of unknown origin."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from hypothesis import strategies as st

from benchmarks.fuzz.damaged import damaged_json, damaged_text, damaged_xml
from benchmarks.golden.cases import golden_cases
from ikplan.documents import parse, parse_json
from ikplan.documents.requests.fk import FkRequest
from ikplan.documents.requests.ik import IkRequest
from ikplan.robots import RobotUpload, catalogue_robot
from ikplan.robots.folders import package_file, robot_folder
from ikplan_api.workers.point_file import read_point_file
from ikplan_api.workers.scene_file import read_scene_file
from ikplan_api.workers.tasks import TaskInput, identify

__all__ = ["TARGETS", "Target"]

_ROOT = Path(__file__).parents[2]
_DRAWN = ("ur5", "panda", "z1", "baxter_left", "so101", "kinova_j2s6s200")


class Target(NamedTuple):
    """A reader and what it is given.

    Attributes:
        read: Reads a document; raises an IkplanError for a wrong one, and nothing else.
        documents: Makes documents.
        most_bytes: Longest document that the service passes on to it [bytes].
    """

    read: Callable[[bytes], object]
    documents: Callable[[], st.SearchStrategy[bytes]]
    most_bytes: int = 8 * 2**20


def _requests(kind: str) -> list[Any]:
    written = itertools.takewhile(lambda case: not case[0].startswith("random/"), golden_cases())
    return [document for _, name, document in written if name == kind]


def _poses() -> st.SearchStrategy[bytes]:
    fk = {"robot": "ur5", "q": [0.0, -1.2, 1.5, 0.0, 1.0, 0.0]}
    ik = {"robot": "iiwa14", "position": [0.5, 0.0, 0.5], "quaternion_xyzw": [0, 1, 0, 0]}
    return damaged_json([fk, ik, {**ik, "scene": _scene(), "budget_s": 1.0, "ik": {"seed": 3}}])


def _scene() -> dict[str, Any]:
    cell: dict[str, Any] = yaml.safe_load((_ROOT / "examples/cell_panda.yaml").read_text())
    return cell


def _read_pose(document: bytes) -> None:
    for model in (FkRequest, IkRequest):
        parse_json(model, document)


def _urdfs() -> list[str]:
    texts = []
    for name in _DRAWN:
        urdf = yaml.safe_load((robot_folder(name) / "robot.yaml").read_text())["kinematics"]["urdf"]
        texts.append(package_file(urdf["package"], urdf["path"]).read_text())
    return [*texts, _arm(6), _arm(1), "<robot name='r'><link name='l'/></robot>"]


def _arm(joints: int) -> str:
    parts = ['<robot name="arm"><link name="l0"/>']
    for i in range(joints):
        parts.append(
            f'<link name="l{i + 1}"/><joint name="j{i + 1}" type="revolute">'
            f'<origin xyz="0 0 0.2" rpy="0 0 0"/><parent link="l{i}"/><child link="l{i + 1}"/>'
            f'<axis xyz="0 {i % 2} {1 - i % 2}"/>'
            '<limit lower="-2.5" upper="2.5" velocity="2" effort="50"/></joint>'
        )
    return "".join([*parts, "</robot>"])


def _read_urdf(document: bytes) -> None:
    try:
        text = document.decode()
    except UnicodeDecodeError:
        return  # refused by the route
    parse(RobotUpload, {"urdf": text}).describe()


def _build_urdf(document: bytes) -> None:
    try:
        text = document.decode()
    except UnicodeDecodeError:
        return
    robot = parse(RobotUpload, {"urdf": text}).robot()
    robot.fk(robot.home)
    robot.jacobian(robot.home)


def _uploads() -> st.SearchStrategy[bytes]:
    arm = _arm(6)
    srdf = (
        '<robot name="arm"><group name="g"><chain base_link="l0" tip_link="l6"/></group>'
        '<group_state name="home" group="g"><joint name="j1" value="0.1"/></group_state></robot>'
    )
    limits = [{"name": "j1", "lower": -1.0, "upper": 1.0, "velocity": 1.0, "acceleration": 2.0}]
    return damaged_json(
        [
            {"urdf": arm, "title": "arm", "tip": "l6"},
            {"urdf": arm, "srdf": srdf, "group": "g", "joints": limits, "home": [0.1] * 6},
            {"urdf": arm, "coupling": {"j3": {"j2": 1, "j3": 1}}, "tool": {"position": [0, 0, 1]}},
        ]
    )


def _read_upload(document: bytes) -> None:
    parse_json(RobotUpload, document).describe()


def _points() -> st.SearchStrategy[bytes]:
    names = ("points_ur5.csv", "points_cell.csv")
    texts = [(_ROOT / "examples" / name).read_text() for name in names]
    texts += ["x,y,z,qx,qy,qz,qw\n0.4,0,0.3,0,1,0,0\n", "j1,j2,j3,j4,j5,j6\n0,0,0,0,0,0\n"]
    texts += ["x;y;z;a;b;c\n400;0;300;0;180;0\n", "X\tY\tZ\tW\tP\tR\n400\t0\t300\t180\t0\t0\n"]
    damaged = damaged_text(st.sampled_from(texts)) | st.sampled_from(texts)
    return damaged.map(lambda text: text.encode(errors="surrogatepass"))


def _read_points(document: bytes) -> None:
    read_point_file(document, {"robot": "ur5"}, catalogue_robot("ur5"))


def _identified(kind: str) -> Callable[[bytes], object]:
    return lambda document: identify(kind, TaskInput(document))


def _targets() -> Iterator[tuple[str, Target]]:
    yield "plan", Target(_identified("plan"), lambda: damaged_json(_requests("plan")))
    yield "timing", Target(_identified("time"), lambda: damaged_json(_requests("timing")))
    yield "poses", Target(_read_pose, _poses, 64 * 1024)
    yield "scene", Target(read_scene_file, lambda: damaged_json([_scene()]))
    yield "points", Target(_read_points, _points)
    yield "urdf", Target(_read_urdf, lambda: damaged_xml(_urdfs()), 2**20)
    yield "upload", Target(_read_upload, _uploads, 6 * 2**20 + 2**16)
    yield "build", Target(_build_urdf, lambda: damaged_xml(_urdfs()), 2**20)


TARGETS: dict[str, Target] = dict(_targets())
"""The readers by name. ``build`` is what a process of its own does with an upload."""
