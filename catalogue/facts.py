"""What each source publishes of an arm, read from ``facts.yaml`` and checked."""

from __future__ import annotations

import functools
from pathlib import Path
from typing import Literal

import yaml
from pydantic import BaseModel, ConfigDict, Field, model_validator

from ikplan.documents.controller import Controller

__all__ = ["Arm", "Counting", "Facts", "FactsJoint", "Source", "read_facts"]

Triple = tuple[float, float, float]
_FILE = Path(__file__).parent / "facts.yaml"


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)


class Source(_Strict):
    """A repository of descriptions."""

    repository: str
    commit: str
    official: bool
    license: str
    where: str | None = None


class Origin(_Strict):
    """A frame in its parent: position [m] and roll-pitch-yaw [rad]."""

    xyz: Triple
    rpy: Triple


class FactsJoint(Origin):
    """A serial joint in the frame of the one before, with its published limits [rad or m]."""

    name: str
    type: Literal["revolute", "continuous", "prismatic"] = "revolute"
    axis: Triple
    lower: float | None = None
    upper: float | None = None
    velocity: float = Field(gt=0)
    acceleration: float | None = Field(None, gt=0)
    effort: float | None = Field(None, gt=0)


class CountedJoint(_Strict):
    """A joint as a controller counts it, with its limits [rad or m]."""

    name: str
    lower: float
    upper: float
    velocity: float = Field(gt=0)


class Counting(_Strict):
    """How a controller counts: serial joint values are ``matrix @ counted``."""

    source: str
    matrix: list[list[float]]
    limits: str
    joints: list[CountedJoint]


class Arm(_Strict):
    """One arm."""

    name: str
    title: str
    maker: str
    source: str
    file: str
    acceleration_file: str | None = None
    acceleration_document: str | None = None
    controller: str | None = None
    base: str
    tip: str
    tool: Origin
    notes: list[str] = []
    joints: list[FactsJoint]
    counting: Counting | None = None

    @model_validator(mode="after")
    def _complete(self) -> Arm:
        known = [j.acceleration is not None for j in self.joints]
        named = (self.acceleration_file is not None) + (self.acceleration_document is not None)
        if any(known) != all(known) or named != any(known):
            raise ValueError(f"{self.name}: accelerations: all with one source, or none")
        for joint in self.joints:
            bounded = joint.lower is not None and joint.upper is not None
            if bounded == (joint.type == "continuous"):
                raise ValueError(f"{self.name}: {joint.name}: lower and upper do not fit its type")
        return self


class Facts(_Strict):
    """Every arm, with the sources and controllers that they name."""

    sources: dict[str, Source]
    controllers: dict[str, Controller]
    arms: list[Arm]

    @model_validator(mode="after")
    def _known(self) -> Facts:
        for arm in self.arms:
            if arm.source not in self.sources:
                raise ValueError(f"{arm.name}: no source {arm.source!r}")
            if arm.controller is not None and arm.controller not in self.controllers:
                raise ValueError(f"{arm.name}: no controller {arm.controller!r}")
        if len({arm.name for arm in self.arms}) != len(self.arms):
            raise ValueError("an arm is given twice")
        return self

    def source_of(self, arm: Arm) -> Source:
        """The repository that an arm comes from."""
        return self.sources[arm.source]


@functools.cache
def read_facts(file: Path = _FILE) -> Facts:
    """Read and check the facts.

    Raises:
        ValidationError: A field is missing, unknown or wrong; it is named.
    """
    return Facts.model_validate(yaml.safe_load(file.read_text(encoding="utf-8")))
