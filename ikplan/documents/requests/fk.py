"""The request for the tool pose of joint values."""

from __future__ import annotations

from pydantic import Field

from ikplan.documents import Document, Floats
from ikplan.documents.poses import Frame

__all__ = ["FkRequest"]


class FkRequest(Document):
    """Joint values whose tool pose is asked for."""

    robot: str = Field(min_length=1, max_length=200, description="Name of a robot.")
    q: Floats = Field(description="Joint values, shape (dof,) [rad or m].")
    tool: Frame = Field(
        default_factory=Frame, description="The tool frame (TCP), in the tip frame."
    )
