"""What robots look like: the URDF that is drawn, its meshes, and no way to any other file."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import httpx
import numpy as np
import pinocchio as pin
import pytest

from ikplan.errors import InvalidRobot
from ikplan.robots import catalogue_robot, catalogue_visual, folders, robot_from_urdf, robot_names
from ikplan.robots.urdf.meshes import find_mesh
from ikplan.robots.urdf.visual import robot_visual
from tests.present import present

GOOD_URI = "package://example-robot-data/robots/xarm_description/meshes/xarm7/visual/link1.stl"
GOOD_PATH = "xarm_description/meshes/xarm7/visual/link1.stl"
BAD_URIS = [
    "",
    "file:///etc/passwd",
    "/etc/passwd",
    "https://example.org/a.stl",
    "package://",
    "package:///etc/passwd.stl",
    "package://example-robot-data/robots/../../../../../etc/passwd",
    "package://example-robot-data/robots/xarm_description/../../a.stl",
    "package://xarm_description/./meshes/xarm7/visual/link1.stl",
    "package://xarm_description//meshes/xarm7/visual/link1.stl",
    "package://xarm_description\\meshes\\a.stl",
    "package://xarm_description/%2e%2e/a.stl",
    "package://xarm_description/meshes/none.stl",
    "package://xarm_description/urdf/xarm7.urdf",
    "package://xarm_description/meshes/a\x00.stl",
    "package://nowhere/a.stl",
    "package://package://xarm_description/meshes/xarm7/visual/link1.stl",
    f"{GOOD_URI}?x",
    f"{GOOD_URI}#x",
]


def mesh_names(urdf: str) -> set[str]:
    return {str(mesh.get("filename")) for mesh in ET.fromstring(urdf).iter("mesh")}


@pytest.mark.parametrize("name", robot_names())
def test_every_robot_has_a_urdf_whose_kinematics_are_its_own(name: str) -> None:
    robot = catalogue_robot(name)
    visual = catalogue_visual(name, lambda path: f"mesh/{path}")
    model = pin.buildModelFromXML(visual.urdf)
    data = model.createData()
    base, tip = (
        model.getFrameId(link, pin.FrameType.BODY) for link in (robot.base_frame, robot.tip_frame)
    )
    # The same joints in the same order: the model's own configuration is this one's too.
    q = robot.configuration(robot.home)
    pin.framesForwardKinematics(model, data, q)
    drawn = data.oMf[base].inverse() * data.oMf[tip] * robot.T_tip_tool
    np.testing.assert_allclose(drawn.homogeneous, robot.fk(robot.home).homogeneous, atol=1e-12)
    assert visual.left_out == ()
    assert mesh_names(visual.urdf) == {f"mesh/{path}" for path in visual.meshes}
    assert all(file.is_file() for file in visual.meshes.values())


def test_robots_of_urdfs_have_meshes_and_those_of_tables_have_none() -> None:
    with_meshes = {name for name in robot_names() if catalogue_visual(name, str).meshes}
    assert {"panda", "ur5", "xarm7", "so101"} <= with_meshes
    assert not {"iiwa14", "eod_arm", "dobot_magician"} & with_meshes


def test_limits_of_the_joints_are_the_robots() -> None:
    robot = catalogue_robot("ur5")
    limits = {
        joint.get("name"): joint.find("limit")
        for joint in ET.fromstring(catalogue_visual("ur5", str).urdf).iter("joint")
    }
    for name, lower, velocity in zip(
        robot.joint_names, robot.lower, robot.velocity_limit, strict=True
    ):
        limit = limits[name]
        assert limit is not None
        assert float(limit.get("lower", "")) == pytest.approx(lower)
        assert float(limit.get("velocity", "")) == pytest.approx(velocity)


def test_a_mesh_of_the_package_is_found_by_both_spellings() -> None:
    path, file = find_mesh(GOOD_URI)
    assert path == GOOD_PATH
    assert file.is_file()
    assert find_mesh("package://" + GOOD_PATH) == (path, file)


@pytest.mark.parametrize("uri", BAD_URIS)
def test_no_other_file_is_found(uri: str) -> None:
    with pytest.raises(InvalidRobot):
        find_mesh(uri)


def test_a_symbolic_link_out_of_the_package_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    root = tmp_path / "robots"
    (root / "arm").mkdir(parents=True)
    (root / "arm" / "own.stl").write_bytes(b"solid")
    (tmp_path / "secret.stl").write_bytes(b"secret")
    (root / "arm" / "link.stl").symlink_to(tmp_path / "secret.stl")
    (root / "inside.stl").symlink_to(root / "arm" / "own.stl")
    monkeypatch.setattr(folders, "_package_roots", lambda *_: [root])
    assert find_mesh("package://arm/own.stl")[1] == root / "arm" / "own.stl"
    assert find_mesh("package://inside.stl")[1] == root / "arm" / "own.stl"
    with pytest.raises(InvalidRobot, match="leads out"):
        find_mesh("package://arm/link.stl")


URDF = """<robot name="r">
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="base"><visual>{visual}</visual></link><link name="tip"/>
  <joint name="j" type="revolute"><parent link="base"/><child link="tip"/>
    <origin xyz="0 0 1"/><axis xyz="0 0 1"/><limit lower="-1" upper="1" velocity="1" effort="1"/>
  </joint></robot>"""


def drawn(visual: str) -> ET.Element:
    document = URDF.format(visual=visual)
    made = robot_visual(robot_from_urdf(document), document.encode(), str)
    return ET.fromstring(made.urdf)


def test_shapes_and_colours_are_kept_and_nothing_else() -> None:
    root = drawn(
        '<origin xyz="1 2 3" onload="x"/><geometry><box size="1 2 3"/></geometry>'
        '<material name="blue"/><script src="x"/>'
    )
    (visual,) = root.iter("visual")
    assert [element.tag for element in visual.iter()] == [
        "visual", "origin", "geometry", "box", "material", "color",
    ]  # fmt: skip
    assert present(visual.find("origin")).attrib == {"xyz": "1.0 2.0 3.0", "rpy": "0.0 0.0 0.0"}
    assert present(visual.find("material/color")).attrib == {"rgba": "0.0 0.0 1.0 1.0"}


@pytest.mark.parametrize("uri", BAD_URIS[1:5])
def test_a_mesh_from_elsewhere_is_left_out_and_told(uri: str) -> None:
    document = URDF.format(visual=f'<geometry><mesh filename="{uri}"/></geometry>')
    made = robot_visual(robot_from_urdf(document), document.encode(), str)
    assert made.left_out == (uri,)
    assert made.meshes == {}
    assert "<mesh" not in made.urdf


@pytest.mark.parametrize("size", ["", "1 2", "1 2 nan", "1 2 inf", "a b c", "1 2 1e9"])
def test_a_shape_of_no_sense_is_refused(size: str) -> None:
    with pytest.raises(InvalidRobot, match="finite numbers"):
        drawn(f'<geometry><box size="{size}"/></geometry>')


def test_the_urdf_over_http_names_addresses_of_the_service(http: httpx.Client) -> None:
    answer = http.get("/v1/robots/xarm7/visual")
    assert answer.status_code == 200
    assert answer.headers["content-type"] == "application/xml"
    for address in mesh_names(answer.text):
        assert address.startswith("/v1/robots/xarm7/meshes/")
        mesh = http.get(address)
        assert mesh.status_code == 200
        assert mesh.headers["content-type"] == "model/stl"
        assert "max-age" in mesh.headers["cache-control"]
    again = http.get("/v1/robots/xarm7/visual", headers={"if-none-match": answer.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


def test_meshes_are_compressed_on_request(http: httpx.Client) -> None:
    (address, *_) = sorted(mesh_names(http.get("/v1/robots/panda/visual").text))
    plain = http.get(address, headers={"accept-encoding": "identity"})
    short = http.get(address, headers={"accept-encoding": "gzip"})
    assert short.headers["content-encoding"] == "gzip"
    assert short.content == plain.content
    assert "content-encoding" not in plain.headers


def test_a_mesh_is_sent_once(http: httpx.Client) -> None:
    address = f"/v1/robots/xarm7/meshes/{GOOD_PATH}"
    answer = http.get(address)
    assert answer.content == find_mesh(GOOD_URI)[1].read_bytes()
    again = http.get(address, headers={"if-none-match": answer.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")


@pytest.mark.parametrize(
    "path",
    [
        "",
        "xarm_description/urdf/xarm7.urdf",
        "panda_description/meshes/visual/link1.dae",
        "../../../../../../etc/passwd",
        "..%2f..%2f..%2fetc%2fpasswd",
        "%2fetc%2fpasswd",
        "/etc/passwd",
        f"{GOOD_PATH}%00",
        GOOD_PATH.upper(),
    ],
)
def test_no_other_file_is_served(http: httpx.Client, path: str) -> None:
    answer = http.get(f"/v1/robots/xarm7/meshes/{path}")
    assert answer.status_code == 404
    assert answer.headers["content-type"] == "application/problem+json"


def test_an_unknown_robot_has_no_visual_and_no_mesh(http: httpx.Client) -> None:
    for address in ("visual", f"meshes/{GOOD_PATH}"):
        answer = http.get(f"/v1/robots/xarm8/{address}")
        assert answer.status_code == 404
        assert answer.json()["type"] == "urn:ikplan:robot-not-found"


def test_an_uploaded_robot_is_drawn_with_meshes_of_the_package_only(http: httpx.Client) -> None:
    shapes = "".join(
        f'<geometry><mesh filename="{uri}"/></geometry></visual><visual>'
        for uri in (GOOD_URI, "package://xarm_description/meshes/none.stl")
    )
    document = URDF.format(visual=shapes)
    sent = http.post("/v1/robots", content=document, headers={"content-type": "application/xml"})
    name = sent.json()["name"]
    (address,) = mesh_names(http.get(f"/v1/robots/{name}/visual").text)
    assert address == f"/v1/robots/{name}/meshes/{GOOD_PATH}"
    assert http.get(address).status_code == 200
    other = GOOD_PATH.replace("link1", "link2")
    assert http.get(f"/v1/robots/{name}/meshes/{other}").status_code == 404
