"""Reading XML of unknown origin: bounded in size, depth and elements, and without a DTD.

A DTD can define entities that grow without bound or read files, and Pinocchio's own parser recurses
on what it is given, so the bounds are kept before anything else sees the document.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from xml.parsers import expat

from ikplan.errors import InvalidRobot

__all__ = ["MAX_BYTES", "MAX_DEPTH", "MAX_ELEMENTS", "read_xml"]

MAX_BYTES = 2_000_000
MAX_DEPTH = 32
MAX_ELEMENTS = 50_000


class _Builder:
    """Builds the element tree, refusing what is not allowed as soon as it is seen."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        self.tree = ET.TreeBuilder()
        self.depth = 0
        self.elements = 0

    def start(self, tag: str, attributes: dict[str, str]) -> None:
        self.depth += 1
        self.elements += 1
        if self.depth > MAX_DEPTH:
            raise InvalidRobot(
                f"{self.robot}: XML elements are nested more than {MAX_DEPTH} deep (at <{tag}>)",
                robot=self.robot,
                value=tag,
            )
        if self.elements > MAX_ELEMENTS:
            raise InvalidRobot(
                f"{self.robot}: more than {MAX_ELEMENTS} XML elements", robot=self.robot
            )
        self.tree.start(tag, attributes)

    def end(self, tag: str) -> None:
        self.depth -= 1
        self.tree.end(tag)

    def doctype(self, name: str, *_: object) -> None:
        raise InvalidRobot(
            f"{self.robot}: a document type definition (<!DOCTYPE {name} ...>) is not allowed",
            robot=self.robot,
            value=name,
        )


def read_xml(document: bytes, *, robot: str) -> ET.Element:
    """Parse an XML document of at most :data:`MAX_BYTES` bytes.

    Args:
        document: The bytes of the document.
        robot: Name of the robot or file, for messages.

    Returns:
        The root element. Character data is dropped: a URDF keeps everything in attributes.

    Raises:
        InvalidRobot: The document is too large, too deep, has a DTD, or is not XML.
    """
    if len(document) > MAX_BYTES:
        raise InvalidRobot(
            f"{robot}: {len(document)} bytes; a robot description may have {MAX_BYTES}",
            robot=robot,
            value=len(document),
        )
    builder = _Builder(robot)
    parser = expat.ParserCreate()
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.StartDoctypeDeclHandler = builder.doctype
    try:
        parser.Parse(document, True)
    except (expat.ExpatError, ValueError, LookupError) as error:
        # ValueError and LookupError: an encoding that Python does not offer.
        raise InvalidRobot(f"{robot}: not XML: {error}", robot=robot) from error
    return builder.tree.close()
