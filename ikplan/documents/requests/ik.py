"""The requests for the joint values of tool poses: of one, and of many."""

from __future__ import annotations

from typing import Annotated

from pydantic import BeforeValidator, Discriminator, Field, Tag, field_validator, model_validator

from ikplan.documents import (
    BUDGET_COUNTS,
    MAX_BUDGET_S,
    Document,
    Floats,
    IfGiven,
    Vec3,
    as_list,
)
from ikplan.documents.poses import Quaternion, Tolerance, Waypoint, unit_quaternion
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.documents.scene import FixedJoints, GivenScene, ToolFrame

__all__ = ["IkBatchRequest", "IkRequest"]


class IkRequest(Document):
    """A tool pose whose joint values are asked for."""

    robot: str = Field(min_length=1, max_length=200, description="Name of a robot.")
    position: Vec3 = Field(description="Tool position in the robot's base [m].")
    quaternion_xyzw: Quaternion | None = Field(
        None,
        description="Tool orientation, unit quaternion (x, y, z, w); absent: any orientation.",
    )
    start: Floats | None = Field(
        None,
        description="Joint values to stay close to [rad or m]; null: those that `ik.posture` "
        "prefers, else the robot's home.",
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
    ik: IkOptions = Field(default_factory=IkOptions)
    tolerance: Tolerance = Field(default_factory=lambda: Tolerance(position=1e-6, orientation=1e-6))
    verdict: bool = Field(
        True,
        description="Whether a pose without a solution is explained; false: a bare no, which "
        "takes a fraction of the time. The method lm gives up after 200 restarts then.",
    )
    budget_s: float = Field(
        10.0, gt=0, le=MAX_BUDGET_S, description=f"Time budget of the solver [s]: {BUDGET_COUNTS}."
    )

    _check = field_validator("quaternion_xyzw")(unit_quaternion)

    @model_validator(mode="after")
    def _no_motion(self) -> IkRequest:
        if self.ik.objective == "time":
            raise ValueError("ik.objective: a pose has no motion time; time is for plans")
        return self

    @model_validator(mode="after")
    def _chosen_by_posture(self) -> IkRequest:
        if self.ik.posture is not None and not self.ik.refine:
            raise ValueError("ik.posture chooses among refined solutions; ik.refine is false")
        return self


MAX_POSES = 20_000
"""Most poses of one request."""


def _starts_tag(value: object) -> str:
    nested = isinstance(value, list) and bool(value) and isinstance(value[0], list)
    return "[rows]" if nested else "[values]"


Starts = Annotated[
    Annotated[Floats, Tag("[values]")] | Annotated[list[Floats], Tag("[rows]")],
    Discriminator(_starts_tag),
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
        "takes a fraction of the time. The method lm gives up after 200 restarts then.",
    )
    budget_s: float = Field(
        10.0, gt=0, le=MAX_BUDGET_S, description=f"Time budget of all poses [s]: {BUDGET_COUNTS}."
    )

    @model_validator(mode="after")
    def _no_motion(self) -> IkBatchRequest:
        if self.ik.objective == "time":
            raise ValueError("ik.objective: poses have no motion time; time is for plans")
        return self

    @model_validator(mode="after")
    def _of_one_kind(self) -> IkBatchRequest:
        if self.ik.posture is not None:
            raise ValueError("ik.posture is for plans and single poses, not for batches of poses")
        oriented = sum(pose.quaternion_xyzw is not None for pose in self.poses)
        if oriented not in (0, len(self.poses)):
            raise ValueError("all poses have an orientation, or none")
        each = isinstance(self.start, list) and self.start and isinstance(self.start[0], list)
        if each and self.start is not None and len(self.start) != len(self.poses):
            raise ValueError(f"{len(self.poses)} poses have {len(self.start)} starts")
        return self
