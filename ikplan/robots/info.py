"""What a user sees of a robot, ready for JSON."""

from __future__ import annotations

import math

from pydantic import BaseModel, ConfigDict, Field

from ikplan.documents import AT_FIRST_USE
from ikplan.documents.controller import Controller
from ikplan.robots.description import RobotDescription

__all__ = [
    "AllowedPairInfo",
    "BodyInfo",
    "CollisionInfo",
    "CouplingInfo",
    "JointInfo",
    "LimitSourceInfo",
    "RobotInfo",
    "robot_info",
]


class JointInfo(BaseModel):
    """One joint. Angles in rad, lengths in m; null: no limit, or none known."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    name: str
    type: str = Field(description="revolute, continuous or prismatic")
    lower: float | None = Field(description="lower position limit [rad or m]; null: none")
    upper: float | None = Field(description="upper position limit [rad or m]; null: none")
    velocity: float = Field(description="velocity limit [rad/s or m/s]")
    acceleration: float = Field(description="acceleration limit [rad/s^2 or m/s^2]")
    effort: float | None = Field(description="effort limit [N m or N]; null: not known")
    home: float = Field(description="home position [rad or m]")


class LimitSourceInfo(BaseModel):
    """Where one kind of limit comes from."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    limit: str = Field(description="position, velocity, acceleration or effort")
    source: str | None = Field(description="the document or file; null: a default")
    default: str | None = Field(description="name of the default; null: a sourced limit")
    verified: bool = Field(description="whether the source could be confirmed")


class CouplingInfo(BaseModel):
    """How serial joints follow the user's joints: their values are ``matrix @ q + offset``."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    serial: list[str] = Field(description="the serial joints, from base to tip")
    matrix: list[list[float]] = Field(description="one row a serial joint, one column a joint")
    offset: list[float] = Field(description="one number a serial joint [rad or m]")


class BodyInfo(BaseModel):
    """The shape of a link: convex pieces that enclose it."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    name: str
    joint: str | None = Field(description="the joint that moves it; null: it stands with the base")
    pieces: int
    points: int = Field(description="points of all pieces")
    source: str = Field(description="where the shape comes from")
    excess: float = Field(description="how far the pieces reach beyond what they enclose [m]")


class AllowedPairInfo(BaseModel):
    """Two links that may touch, and why."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    pair: list[str]
    reason: str


class CollisionInfo(BaseModel):
    """What is checked for collisions of the arm with itself."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    bodies: list[BodyInfo]
    pairs_checked: int = Field(description="pairs of links that are kept apart")
    allowed: list[AllowedPairInfo] = Field(
        description="pairs that may touch; those on one joint, which never move against each "
        "other, are not listed"
    )
    unchecked: list[str] = Field(description="links of which no shape is known")
    fixed_joints: dict[str, float] = Field(
        description="where the joints beside the chain stand [rad or m]"
    )
    notes: list[str]


class RobotInfo(BaseModel):
    """A robot: names, limits, frames and where they come from."""

    model_config = ConfigDict(extra="forbid", defer_build=AT_FIRST_USE)

    name: str
    title: str
    dof: int
    joints: list[JointInfo] = Field(description="the user's joints, from base to tip")
    base_frame: str
    tip_frame: str
    coupled: bool = Field(description="whether the serial joints follow a linear coupling")
    coupling: CouplingInfo | None = Field(None, description="that coupling; null: none")
    tool_position: list[float] = Field(description="tool frame in the tip frame [m]")
    tool_quaternion_xyzw: list[float] = Field(description="tool frame in the tip frame")
    limit_sources: list[LimitSourceInfo]
    sources: list[str]
    notes: list[str]
    assumptions: list[str] = Field(
        [], description="limits that no source gives, in words; empty: every limit has a source"
    )
    controller: Controller | None = Field(
        None, description="The controller: cycle, jerk limits, languages; null: none is known."
    )
    inertias_sourced: bool = Field(description="whether dynamics may be computed from the model")
    collision: CollisionInfo | None = Field(
        None, description="the shapes of its links; null: not asked for"
    )
    fingerprint: str = Field(description="SHA-256 over all that can change a plan")


def robot_info(d: RobotDescription, fingerprint: str) -> RobotInfo:
    """Return what a user sees of a described robot.

    Args:
        d: The description.
        fingerprint: Its fingerprint.
    """
    return RobotInfo(
        name=d.name,
        title=d.title,
        dof=len(d.joints),
        joints=[
            JointInfo(
                name=j.name,
                type=j.kind,
                lower=_finite(j.lower),
                upper=_finite(j.upper),
                velocity=j.velocity,
                acceleration=j.acceleration,
                effort=_finite(j.effort),
                home=j.home,
            )
            for j in d.joints
        ],
        base_frame=d.base,
        tip_frame=d.tip,
        coupled=d.coupling is not None,
        coupling=None
        if d.coupling is None
        else CouplingInfo(
            serial=list(d.coupling.serial),
            matrix=[list(row) for row in d.coupling.matrix],
            offset=list(d.coupling.offset),
        ),
        tool_position=list(d.tool.position),
        tool_quaternion_xyzw=list(d.tool.quaternion_xyzw),
        limit_sources=[
            LimitSourceInfo(limit=s.limit, source=s.source, default=s.default, verified=s.verified)
            for s in d.limit_sources
        ],
        sources=list(d.sources),
        assumptions=list(d.assumptions),
        notes=[*d.notes, *(f"{s.limit} limits: {s}" for s in d.limit_sources)],
        inertias_sourced=d.inertias_sourced,
        controller=d.controller,
        fingerprint=fingerprint,
    )


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
