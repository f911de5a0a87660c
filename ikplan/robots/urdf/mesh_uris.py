"""Where the meshes of a description of unknown origin may lead: into a package, nowhere else.

Pinocchio and urdfdom read what a mesh's URI names, ``file:///etc/passwd`` and
``package://x/../../y`` included. Planning needs no mesh: a description is written anew without any,
so that nothing later follows an address. One that could leave its package is named in a note.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator
from urllib.parse import unquote

from ikplan.errors import InvalidRobot
from ikplan.robots.urdf.safe_xml import read_xml

__all__ = ["check_mesh_uri", "mesh_notes"]

ALLOWED = ("package://<package>/<path>", "<path>")
_ENCODINGS = 8
"""How often an address may be percent-encoded before nobody can mean it."""


def mesh_notes(document: bytes, *, robot: str) -> list[str]:
    """Return what to say of the meshes and textures of a URDF; open none.

    Args:
        document: The bytes of the URDF.
        robot: Name of the robot, for messages.

    Returns:
        A sentence that names the packages, in the order of the document, and one that counts the
        addresses that lead out of any and names the first.

    Raises:
        InvalidRobot: The document is not XML.
    """
    packages: dict[str, None] = {}
    dropped: list[str] = []
    for where, uri in _addresses(read_xml(document, robot=robot)):
        try:
            packages[check_mesh_uri(uri, where=where, robot=robot)] = None
        except InvalidRobot as error:
            dropped.append(error.detail.removeprefix(f"{robot}: "))
    notes = []
    if packages:
        named = ", ".join(p for p in packages if p) or "paths beside the URDF"
        notes.append(f"meshes are not needed and were not opened: {named}")
    if dropped:
        notes.append(
            f"{len(dropped)} addresses of meshes cannot be used and were dropped; the first: "
            f"{dropped[0]}"
        )
    return notes


def _addresses(root: ET.Element) -> Iterator[tuple[str, str]]:
    for element in root:
        where = f"{element.tag} {element.get('name', '')[:200]!r}"
        for part in element.iter():
            for key in ("filename", "file", "url", "uri"):
                if part.tag in ("mesh", "texture") and key in part.attrib:
                    yield where, part.attrib[key]


def check_mesh_uri(uri: str, *, where: str, robot: str) -> str:
    """Return the package that an address stays inside, "" for a path without one.

    Raises:
        InvalidRobot: It has another scheme, is absolute, or climbs out with ``..``, in whatever
            spelling.
    """
    plain = uri
    for _ in range(_ENCODINGS):
        decoded = unquote(plain)
        if decoded == plain:
            break
        plain = decoded
    else:
        raise _refused(robot, where, uri, "it is percent-encoded again and again")
    plain = plain.replace("\\", "/")
    if not plain.isprintable():
        raise _refused(robot, where, uri, "it has characters that cannot be printed")
    scheme, colon, rest = plain.partition(":")
    package = ""
    if colon:
        if scheme.strip().lower() != "package" or not rest.startswith("//"):
            raise _refused(robot, where, uri, f"{scheme.strip()[:40]!r} is not a scheme for meshes")
        package, _, plain = rest[2:].partition("/")
        if not package.strip():
            raise _refused(robot, where, uri, "it names no package")
        if ":" in plain:
            raise _refused(robot, where, uri, "it has a second scheme")
    if not package and plain.strip().startswith(("/", "~")):
        raise _refused(robot, where, uri, "it is an absolute path")
    # A segment of dots and spaces alone is `..` to some systems.
    if any(s.strip(" .") == "" and s.count(".") > 1 for s in (package, *plain.split("/"))):
        raise _refused(robot, where, uri, "it climbs out of its folder with '..'")
    return package


def _refused(robot: str, where: str, uri: str, why: str) -> InvalidRobot:
    return InvalidRobot(
        f"{robot}: the mesh of {where} is at {uri[:200]!r}: {why}; "
        f"an address may be {' or '.join(ALLOWED)}",
        robot=robot,
        value=uri[:200],
        valid=ALLOWED,
    )
