"""The request for a plan: the one language of HTTP, the shell, Python and batches.

SI units: metres, radians, seconds. Quaternions are ``xyzw``. Poses are of the tool frame, in the
path frame unless said otherwise.
"""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Field, Tag, model_validator

from ikplan.documents import (
    BUDGET_COUNTS,
    MAX_BUDGET_S,
    Document,
    Floats,
    IfGiven,
    as_list,
    content_hash,
)
from ikplan.documents.limits import LimitOptions, SamplingOptions
from ikplan.documents.path import Event, PathRequest
from ikplan.documents.requests.ik_options import IkOptions
from ikplan.documents.scene import UNCHECKED, FixedJoints, GivenScene, Scene, ToolFrame

__all__ = ["PlanRequest", "json_schema"]


def _start_tag(value: Any) -> str:
    return "[free]" if isinstance(value, str) else "[values]"


# Tagged, so that an error names the form that the user wrote, not both.
Start = Annotated[
    Annotated[Floats, Tag("[values]")] | Annotated[Literal["free"], Tag("[free]")],
    Discriminator(_start_tag),
]


class PlanRequest(Document):
    """A request for a plan (v1)."""

    robot: str = Field(min_length=1, max_length=200, description="Name of a robot.")
    start: Start | None = Field(
        None,
        description='Joint values at the start [rad or m]; null: the robot\'s home; "free": any.',
    )
    tool: ToolFrame = Field(
        default_factory=ToolFrame,
        description="The tool frame (TCP), in the tip frame, and the shape of the tool.",
    )
    scene: Annotated[GivenScene | None, IfGiven()] = Field(
        None,
        description="What stands around the arm and what it carries, or the id of a scene that "
        "the service holds; null: nothing, and the arm is checked against itself.",
    )
    fixed_joints: FixedJoints = Field(
        {},
        description="Values of joints beside the chain, such as a gripper's fingers [rad or m]; "
        "absent: as the robot's description has them.",
    )
    path: PathRequest
    start_velocity: Annotated[Floats | None, IfGiven()] = Field(
        None,
        description="Joint velocities at the start, shape (dof,) [rad/s or m/s], for a robot that "
        "moves already; null: at rest. Joint motions begin tangent to it; a tool path has to begin "
        "along it. What is not feasible is refused with the nearest that is.",
    )
    start_acceleration: Annotated[Floats | None, IfGiven()] = Field(
        None,
        description="Joint accelerations at the start, shape (dof,) [rad/s^2 or m/s^2]; they count "
        "where jerks are limited. null: none.",
    )
    end_velocity: Annotated[Floats | None, IfGiven()] = Field(
        None,
        description="Joint velocities at the end, shape (dof,) [rad/s or m/s]; null: at rest.",
    )
    events: Annotated[list[Event], BeforeValidator(as_list), Field(max_length=1_000), IfGiven()] = (
        Field([], description="Places and times of the motion whose exact times are wanted.")
    )
    ik: IkOptions = Field(default_factory=IkOptions)
    limits: LimitOptions = Field(default_factory=LimitOptions)
    sampling: SamplingOptions = Field(default_factory=SamplingOptions)
    repairs: Annotated[Annotated[int, Field(ge=0)] | None, IfGiven()] = Field(
        None,
        description="Repairs at most that are looked for where there is no plan, in order of "
        "price; 0: none, the refusal is explained all the same. null: one of every kind. Each is "
        "planned to the end before it is offered, so that looking for all takes as long as ten "
        "plans and more.",
    )
    budget_s: float = Field(
        10.0, gt=0, le=MAX_BUDGET_S, description=f"Time budget of the planner [s]: {BUDGET_COUNTS}."
    )

    @model_validator(mode="after")
    def _known_start(self) -> PlanRequest:
        if self.start == "free" and self.start_velocity is not None:
            raise ValueError("start_velocity: a robot that moves has a start; it is not free")
        return self

    def content_hash(self, *context: str) -> str:
        """Return the plan's id: a hash of this request in canonical form and its context.

        A request without a scene is one with an empty scene; one that switches every check off
        is hashed as if there were no scenes.

        Args:
            context: What else decides the plan: the robot's fingerprint and the version.

        Returns:
            32 hexadecimal digits.
        """
        scene = Scene() if self.scene is None else self.scene
        checked = None if scene == UNCHECKED else scene
        return content_hash(self.model_copy(update={"scene": checked}), *context)


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of the plan request, every default and unit included."""
    return PlanRequest.model_json_schema()
