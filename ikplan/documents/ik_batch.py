"""The request of many poses of one robot."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from ikplan.documents import Document, Floats, IfGiven, as_list
from ikplan.documents.plan_request import IkOptions
from ikplan.documents.poses import Tolerance, Waypoint
from ikplan.documents.scene import FixedJoints, GivenScene, ToolFrame

__all__ = ["MAX_POSES", "IkBatchRequest"]

MAX_POSES = 20_000
"""Most poses of one request."""


def _start_tag(value: object) -> str:
    nested = isinstance(value, list) and bool(value) and isinstance(value[0], list)
    return "[rows]" if nested else "[values]"


Starts = Annotated[
    Annotated[Floats, Tag("[values]")] | Annotated[list[Floats], Tag("[rows]")],
    Discriminator(_start_tag),
    BeforeValidator(as_list),
]


class IkBatchRequest(Document):
    """Tool poses whose joint values are asked for."""

    robot: str = Field(min_length=1, max_length=200, description="Name of a robot.")
    poses: Annotated[list[Waypoint], BeforeValidator(as_list)] = Field(
        min_length=1,
        max_length=MAX_POSES,
        description="Poses of the tool in the robot's base; all with an orientation, or none.",
    )
    start: Starts | None = Field(
        None,
        description="Joint values to stay close to [rad or m], for all poses or a row for each; "
        "null: the robot's home.",
    )
    tool: ToolFrame = Field(
        default_factory=ToolFrame,
        description="The tool frame (TCP), in the tip frame, and the shape of the tool.",
    )
    scene: Annotated[GivenScene | None, IfGiven()] = Field(
        None,
        description="What stands around the arm and what it carries, or the id of a scene that "
        "the service holds; null: no collisions are checked.",
    )
    fixed_joints: FixedJoints = Field(
        {},
        description="Values of joints beside the chain, such as a gripper's fingers [rad or m]; "
        "absent: as the robot's description has them.",
    )
    ik: IkOptions = Field(default_factory=lambda: IkOptions(method="lm"))
    tolerance: Tolerance = Field(default_factory=lambda: Tolerance(position=1e-6, orientation=1e-6))
    verdict: bool = Field(
        True,
        description="Whether poses without a solution are explained; false: a bare no, which "
        "takes a fraction of the time. The method lm gives up after 100 restarts then.",
    )
    budget_s: float = Field(10.0, gt=0, le=3600, description="Time budget of all poses [s].")

    @model_validator(mode="after")
    def _of_one_kind(self) -> IkBatchRequest:
        oriented = sum(pose.quaternion_xyzw is not None for pose in self.poses)
        if oriented not in (0, len(self.poses)):
            raise ValueError("all poses have an orientation, or none")
        each = isinstance(self.start, list) and self.start and isinstance(self.start[0], list)
        if each and self.start is not None and len(self.start) != len(self.poses):
            raise ValueError(f"{len(self.poses)} poses have {len(self.start)} starts")
        return self
