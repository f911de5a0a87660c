"""A robot as a folder of its own: ``robot.yaml`` and the URDF beside it."""

from __future__ import annotations

import math
import re
import shutil
from pathlib import Path
from typing import Any

import yaml

from ikplan.errors import InvalidRobot
from ikplan.robots.definition.assumptions import is_assumed
from ikplan.robots.description import LimitSource, RobotDescription

__all__ = ["catalogue_name", "write_robot"]

_URDF = "robot.urdf"
_NAME = re.compile(r"[a-z0-9][a-z0-9_-]{0,63}")


def catalogue_name(name: str) -> str:
    """Return a name as the catalogue has them: small letters, digits, ``_`` and ``-``.

    Raises:
        InvalidRobot: Nothing of it is left.
    """
    plain = re.sub(r"[^a-z0-9_-]+", "_", name.lower()).strip("_-")[:64]
    if not _NAME.fullmatch(plain):
        raise InvalidRobot(
            f"{name!r} is no name for a robot: small letters, digits, '_' and '-' are allowed",
            value=name,
        )
    return plain


def write_robot(
    folder: Path, description: RobotDescription, urdf: bytes, *, replace: bool = False
) -> Path:
    """Write a robot into a folder of its own.

    Args:
        folder: The folder of robots; it is made if it is not there.
        description: The robot; its name is that of the new folder.
        urdf: The URDF that it was made from, expanded.
        replace: Whether a robot of that name in the folder may be replaced.

    Returns:
        The robot's folder.

    Raises:
        InvalidRobot: There is one of that name.
        OSError: The folder cannot be written.
    """
    target = folder / description.name
    if target.exists() and not replace:
        raise InvalidRobot(
            f"{description.name}: {target} is there; give another --name, or --replace",
            robot=description.name,
            value=description.name,
        )
    folder.mkdir(parents=True, exist_ok=True)
    new = folder / f".{description.name}.new"
    shutil.rmtree(new, ignore_errors=True)
    new.mkdir()
    (new / _URDF).write_bytes(urdf)
    text = yaml.safe_dump(_document(description), sort_keys=False, allow_unicode=True, width=100)
    (new / "robot.yaml").write_text(text, encoding="utf-8")
    if target.exists():
        shutil.rmtree(target)
    new.rename(target)
    return target


def _document(d: RobotDescription) -> dict[str, Any]:
    """The fields of ``robot.yaml``; limits in SI units, every one of them."""
    document: dict[str, Any] = {
        "name": d.name,
        "title": d.title,
        "sources": [_fact(source) for source in d.sources],
        "kinematics": {"urdf": {"path": _URDF}},
        "base": d.base,
        "tip": d.tip,
        "joints": [],
        "limits": {},
    }
    for joint in d.joints:
        entry: dict[str, Any] = {"name": joint.name, "type": joint.kind}
        for key in ("lower", "upper", "velocity", "acceleration", "effort"):
            value = getattr(joint, key)
            # What is assumed is left to the default by its name, so that it stays an assumption.
            if math.isfinite(value) and not is_assumed(d.assumptions, key, joint.name):
                entry[key] = value
        document["joints"].append(entry)
    for source in d.limit_sources:
        if source.limit != "effort" or any(math.isfinite(j.effort) for j in d.joints):
            document["limits"][source.limit] = _source(source)
    if d.coupling is not None:
        document["coupling"] = {
            "matrix": [list(row) for row in d.coupling.matrix],
            "offset": list(d.coupling.offset),
        }
    document["home"] = [joint.home for joint in d.joints]
    if d.inertias_sourced:
        document["inertias"] = d.sources[0] if d.sources else "the URDF"
    document["notes"] = list(d.notes)
    return document


def _fact(text: str) -> dict[str, str]:
    fact, colon, source = text.partition(": ")
    return {"fact": fact, "source": source} if colon else {"fact": "description", "source": text}


def _source(source: LimitSource) -> dict[str, Any]:
    if source.default is not None:
        return {"default": source.default}
    entry: dict[str, Any] = {"source": source.source}
    if not source.verified:
        entry["verified"] = False
    return entry
