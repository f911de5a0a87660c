"""What a robot looks like: its kinematics with the shapes of its URDF, and nothing else of it."""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from ikplan.errors import InvalidRobot
from ikplan.robots.load import catalogue_documents, catalogue_robot
from ikplan.robots.robot import Robot
from ikplan.robots.urdf.meshes import find_mesh
from ikplan.robots.urdf.safe_xml import read_xml

__all__ = ["RobotVisual", "catalogue_visual", "robot_visual"]

_SHAPES = {"box": {"size": 3}, "cylinder": {"radius": 1, "length": 1}, "sphere": {"radius": 1}}
_MAX_NUMBER = 1e6


@dataclass(frozen=True)
class RobotVisual:
    """What is needed to draw a robot.

    Attributes:
        urdf: A URDF of links, joints with their limits, and visual shapes. Only the joints of the
            chain move. Without shapes for robots that have none.
        meshes: The file of each mesh, by its path below the folder of the package.
        left_out: Meshes that the robot names and that are not drawn, since they are in no known
            package.
    """

    urdf: str
    meshes: dict[str, Path]
    left_out: tuple[str, ...]


def catalogue_visual(name: str, address: Callable[[str], str]) -> RobotVisual:
    """Draw a robot of the catalogue.

    Args:
        name: Name in the catalogue.
        address: Gives the address of a mesh by its path below the folder of the package.

    Raises:
        RobotNotFound: No robot of that name.
        InvalidRobot: Its description makes no sense.
    """
    return robot_visual(catalogue_robot(name), catalogue_documents(name)[1], address)


def robot_visual(robot: Robot, document: bytes, address: Callable[[str], str]) -> RobotVisual:
    """Draw a robot with the shapes that a URDF gives its links.

    Args:
        robot: The robot.
        document: The URDF it comes from; empty: it has no shapes.
        address: Gives the address of a mesh by its path below the folder of the package.

    Raises:
        InvalidRobot: The document is not a URDF, or a shape makes no sense.
    """
    root = ET.fromstring(robot.description.urdf)  # our own writing
    _write_limits(root, robot)
    drawing = _Drawing(robot.name, address)
    if document:
        source = read_xml(document, robot=robot.name)
        colours = {m.get("name", ""): m for m in source.findall("material")}
        links = {link.get("name"): link for link in root.findall("link")}
        for link in source.findall("link"):
            if (target := links.get(link.get("name"))) is not None:
                for visual in link.findall("visual"):
                    drawing.copy(visual, target, colours)
    for link in root.findall("link"):
        for inertial in link.findall("inertial"):
            link.remove(inertial)
    urdf = ET.tostring(root, encoding="unicode")
    return RobotVisual(urdf, drawing.meshes, tuple(drawing.left_out))


def _write_limits(root: ET.Element, robot: Robot) -> None:
    """Replace the placeholders of the bare kinematics by the serial joints' own limits."""
    model = robot.model
    for element in root.iter("joint"):
        limit = element.find("limit")
        if limit is None:
            continue
        joint = model.joints[model.getJointId(element.get("name"))]
        rates = {
            "velocity": model.upperVelocityLimit[joint.idx_v],
            "effort": model.upperEffortLimit[joint.idx_v],
        }
        if joint.nq == 1:
            rates["lower"] = model.lowerPositionLimit[joint.idx_q]
            rates["upper"] = model.upperPositionLimit[joint.idx_q]
        else:
            del limit.attrib["lower"], limit.attrib["upper"]
        for key, value in rates.items():
            # URDF wants an effort; 0 is what authors write when they know none.
            limit.set(key, repr(float(value)) if math.isfinite(value) else "0")


class _Drawing:
    """Copies shapes, each number read and each mesh found."""

    def __init__(self, robot: str, address: Callable[[str], str]) -> None:
        self.robot = robot
        self.address = address
        self.meshes: dict[str, Path] = {}
        self.left_out: list[str] = []

    def copy(self, visual: ET.Element, link: ET.Element, colours: dict[str, ET.Element]) -> None:
        geometry = self._geometry(visual.find("geometry"))
        if geometry is None:
            return
        made = ET.SubElement(link, "visual")
        origin = visual.find("origin")
        if origin is not None:
            given = {k: self._numbers(origin.get(k, "0 0 0"), 3) for k in ("xyz", "rpy")}
            ET.SubElement(made, "origin", given)
        ET.SubElement(made, "geometry").append(geometry)
        material = visual.find("material")
        if material is not None:
            colour = material.find("color")
            if colour is None:
                named = colours.get(material.get("name", ""))
                colour = None if named is None else named.find("color")
            if colour is not None:
                rgba = self._numbers(colour.get("rgba", ""), 4)
                name = ET.SubElement(made, "material", name=material.get("name", ""))
                ET.SubElement(name, "color", rgba=rgba)

    def _geometry(self, geometry: ET.Element | None) -> ET.Element | None:
        for shape in () if geometry is None else geometry:
            if shape.tag == "mesh":
                return self._mesh(shape)
            if (keys := _SHAPES.get(shape.tag)) is not None:
                given = {k: self._numbers(shape.get(k, ""), n) for k, n in keys.items()}
                return ET.Element(shape.tag, given)
        return None

    def _mesh(self, shape: ET.Element) -> ET.Element | None:
        uri = shape.get("filename", "")
        try:
            path, file = find_mesh(uri)
        except InvalidRobot:
            self.left_out.append(uri)
            return None
        self.meshes[path] = file
        scale = self._numbers(shape.get("scale", "1 1 1"), 3)
        return ET.Element("mesh", filename=self.address(path), scale=scale)

    def _numbers(self, text: str, count: int) -> str:
        """The text of so many finite numbers, written anew."""
        try:
            values = [float(part) for part in text.split()]
        except ValueError:
            values = []
        if len(values) != count or not all(abs(v) <= _MAX_NUMBER for v in values):
            raise InvalidRobot(
                f"{self.robot}: a visual shape has {text[:200]!r} where {count} finite numbers "
                "are required",
                robot=self.robot,
                value=text[:200],
            )
        return " ".join(repr(v) for v in values)
