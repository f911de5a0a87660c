"""A robot as plain, frozen data: what a :class:`~ikplan.robots.Robot` is built from."""

from __future__ import annotations

import functools
import hashlib
import json
import math
from dataclasses import dataclass, field
from typing import Any

from ikplan.documents.controller import Controller
from ikplan.robots.urdf.tree import Vector

__all__ = ["Coupling", "JointSpec", "LimitSource", "RobotDescription", "ShapeSource", "Tool"]

Quaternion = tuple[float, float, float, float]


@dataclass(frozen=True)
class JointSpec:
    """One joint of the user: limits and home [rad or m, per second, N m or N].

    Attributes:
        name: Name of the joint.
        kind: revolute, continuous or prismatic.
        lower: Lower position limit, -inf for a continuous joint.
        upper: Upper position limit, inf for a continuous joint.
        velocity: Velocity limit.
        acceleration: Acceleration limit.
        effort: Effort limit, nan where no source gives one.
        home: Home position.
    """

    name: str
    kind: str
    lower: float
    upper: float
    velocity: float
    acceleration: float
    effort: float
    home: float


@dataclass(frozen=True)
class Coupling:
    """Serial joint values ``s = matrix @ q + offset`` of the user's joint values ``q``."""

    serial: tuple[str, ...]
    matrix: tuple[tuple[float, ...], ...]
    offset: tuple[float, ...]


@dataclass(frozen=True)
class Tool:
    """Pose of the tool frame in the tip frame: position [m], unit quaternion xyzw."""

    position: Vector = (0.0, 0.0, 0.0)
    quaternion_xyzw: Quaternion = (0.0, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class LimitSource:
    """Where one kind of limit comes from.

    Attributes:
        limit: position, velocity, acceleration or effort.
        source: The document, package or file, None for a default.
        default: Name of the default, None for a sourced limit.
        verified: Whether the source could be confirmed.
    """

    limit: str
    source: str | None
    default: str | None
    verified: bool = True

    def __str__(self) -> str:
        if self.default is not None:
            return f"default: {self.default}; no source gives one"
        return f"{self.source}" + ("" if self.verified else " (unverified)")


@dataclass(frozen=True)
class ShapeSource:
    """Where the shapes of the links are, unread: a robot is loaded without them.

    Attributes:
        urdf: The document whose collision geometry counts; empty: there is none.
        folder: Folder of that document, for meshes beside it; None: meshes are those of installed
            packages only.
        shapes: The ``collision`` of ``robot.yaml`` as JSON; empty: there is none.
        file: The file of shapes that it names; empty: there is none.
        srdf: The SRDF whose pairs may touch; empty: there is none.
        fixed_joints: Values of joints beside the chain [rad or m]; those not named are at zero.
    """

    urdf: bytes = b""
    folder: str | None = None
    shapes: bytes = b""
    file: bytes = b""
    srdf: bytes = b""
    fixed_joints: tuple[tuple[str, float], ...] = ()

    def fingerprint(self) -> str:
        """SHA-256 over what the shapes come from; files of meshes are not read for it."""
        return self._fingerprint

    @functools.cached_property
    def _fingerprint(self) -> str:
        digest = hashlib.sha256()
        for part in (self.urdf, self.shapes, self.file, self.srdf):
            digest.update(len(part).to_bytes(8, "big") + part)
        digest.update(repr(self.fixed_joints).encode())
        return digest.hexdigest()


@dataclass(frozen=True)
class RobotDescription:
    """Everything a robot is, in numbers and names.

    Attributes:
        name: Short name.
        title: Full name.
        urdf: The bare kinematics and inertias; only the joints of the chain move.
        base: Base link.
        tip: Tip link.
        joints: The user's joints, from base to tip.
        coupling: How the serial joints follow the user's joints, None where they are the same.
        tool: Pose of the tool frame in the tip frame.
        limit_sources: Where each kind of limit comes from.
        sources: Where the other facts come from.
        notes: What a user should know.
        inertias_sourced: Whether the inertias come from a named source.
        controller: The controller, None where none is known; jerks in rad/s^3 or m/s^3, one a
            joint.
        shapes: Where the shapes of the links are.
        assumptions: Limits that no source gives, each in words: a plan's certificate names them.
    """

    name: str
    title: str
    urdf: str
    base: str
    tip: str
    joints: tuple[JointSpec, ...]
    coupling: Coupling | None = None
    tool: Tool = Tool()
    limit_sources: tuple[LimitSource, ...] = ()
    sources: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    inertias_sourced: bool = False
    controller: Controller | None = None
    shapes: ShapeSource = field(default=ShapeSource(), repr=False)
    assumptions: tuple[str, ...] = ()

    def fingerprint(self) -> str:
        """SHA-256 over all that can change a plan without collision checks.

        Prose, file paths and shapes are left out.

        Computed from the numbers as described, before any trigonometry, so that it does not
        depend on the machine.
        """
        coupling = self.coupling
        content: dict[str, Any] = {
            "name": self.name,
            "urdf": self.urdf,
            "base": self.base,
            "tip": self.tip,
            "joints": [
                [j.name, j.kind]
                + [
                    _number(v)
                    for v in (j.lower, j.upper, j.velocity, j.acceleration, j.effort, j.home)
                ]
                for j in self.joints
            ],
            "coupling": None
            if coupling is None
            else [
                list(coupling.serial),
                [[_number(v) for v in row] for row in coupling.matrix],
                [_number(v) for v in coupling.offset],
            ],
            "tool": [_number(v) for v in (*self.tool.position, *self.tool.quaternion_xyzw)],
            "inertias_sourced": self.inertias_sourced,
        }
        if self.controller is not None:
            content["controller"] = _tagged(self.controller.model_dump(exclude={"sources"}))
        text = json.dumps(content, sort_keys=True, separators=(",", ":"))
        return hashlib.sha256(text.encode()).hexdigest()


def _tagged(value: Any) -> Any:
    """Write every float of a document by its bits."""
    if isinstance(value, dict):
        return {key: _tagged(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_tagged(each) for each in value]
    return _number(value) if isinstance(value, float) else value


def _number(value: float) -> str:
    return "nan" if math.isnan(value) else float(value + 0.0).hex()
