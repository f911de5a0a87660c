"""The request documents: the one language of HTTP, the shell, Python and batches.

SI units: metres, radians, seconds. Quaternions are ``xyzw``. Poses are of the tool frame, in the
path frame unless said otherwise.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import (
    BeforeValidator,
    Discriminator,
    Field,
    PlainValidator,
    Tag,
    field_validator,
    model_validator,
)

from ikplan.documents import (
    BUDGET_COUNTS,
    MAX_BUDGET_S,
    Document,
    Floats,
    IfGiven,
    Vec3,
    as_list,
    content_hash,
)
from ikplan.documents.limits import LimitOptions, SamplingOptions
from ikplan.documents.path import Event, PathRequest
from ikplan.documents.poses import (
    Frame,
    Posture,
    Quaternion,
    Tolerance,
    Waypoint,
    unit_quaternion,
)
from ikplan.documents.scene import UNCHECKED, FixedJoints, GivenScene, Scene, ToolFrame

__all__ = [
    "FkRequest",
    "Frame",
    "IkBatchRequest",
    "IkOptions",
    "IkRequest",
    "LimitOptions",
    "PathRequest",
    "PlanRequest",
    "Posture",
    "SamplingOptions",
    "Scene",
    "Tolerance",
    "Waypoint",
]


def _start_tag(value: Any) -> str:
    return "[free]" if isinstance(value, str) else "[values]"


# Tagged, so that an error names the form that the user wrote, not both.
Start = Annotated[
    Annotated[Floats, Tag("[values]")] | Annotated[Literal["free"], Tag("[free]")],
    Discriminator(_start_tag),
]


def _budget_tag(value: Any) -> str:
    return "[name]" if isinstance(value, str) else "[number]"


Budget = Annotated[
    Annotated[int, Field(ge=1, le=100_000), Tag("[number]")]
    | Annotated[Literal["paper"], Tag("[name]")],
    Discriminator(_budget_tag),
]


def _scalar(value: Any) -> bool | int | float | str:
    if not isinstance(value, bool | int | float | str):
        raise ValueError("a parameter is a number, a string, true or false")
    if isinstance(value, float) and not math.isfinite(value):
        raise ValueError("NaN and infinities are not allowed")
    if isinstance(value, int) and abs(value) >= 2**63:
        raise ValueError("a whole number must fit into 64 bits")
    return value


Scalar = Annotated[bool | int | float | str, PlainValidator(_scalar)]


MAX_EVALUATIONS = 10_000_000
"""Most evaluations of one search."""
_LOOKS = {"gsa": 20}
"""Methods in which every individual looks at all others: how many looks take as long as one
evaluation of a candidate (measured: 64 ns and 0.8 us, of half of them on average)."""


class IkOptions(Document):
    """How joint solutions are looked for."""

    method: str = Field("ik-ba", description="Name of a solver; see GET /v1/solvers.")
    seed: int = Field(0, ge=0, lt=2**63, description="Seed of every random choice.")
    population: Budget | None = Field(
        None,
        description="Candidates per iteration, 1 to 100000; null: the planner's own, as small as "
        'keeps its promises; "paper": the number of the method\'s paper. Times the iterations, '
        "at most 10,000,000; gsa, whose individuals all look at each other, allows fewer.",
    )
    iterations: Budget | None = Field(
        None,
        description="Iterations, 1 to 100000; null: the planner's own; \"paper\": the paper's.",
    )
    params: dict[str, Scalar] = Field({}, description="Parameters of the method, by name.")
    refine: bool = Field(
        True, description="Polish the seeds to machine precision; false: the raw solver."
    )
    elongation: Literal["global", "greedy"] = Field(
        "global",
        description='How joint motion is kept small: "global" over the whole path, "greedy" '
        "waypoint by waypoint.",
    )
    objective: Annotated[Literal["motion", "time", "clearance"], IfGiven()] = Field(
        "motion",
        description='What is least: "motion", the motion of the joints; "time", the time that the '
        "motion takes within its limits, never more than that of least joint motion; or "
        '"clearance", how near configurations are to touching anything, which in a plan chooses '
        "those of waypoints that joint motions lead to; paths with tool paths or moves do not "
        "take it.",
    )
    effort: Annotated[
        Annotated[int, Field(ge=1, le=10_000_000)] | None,
        IfGiven(),
    ] = Field(
        None,
        description="Samples drawn at most in the search for the way of a move; for every 200 of "
        "them one shortcut is tried. null: 20,000. The time budget only ends a search, it never "
        "decides what it finds.",
    )
    posture: Annotated[Posture | None, IfGiven()] = Field(
        None,
        description="Which motions are preferred: near a configuration, within soft limits, with "
        "weights of the joints; for plans, and for single poses, whose motion is that from the "
        "start; not for batches of poses. null: those of least joint motion, all joints alike.",
    )

    move_engine: Annotated[
        Literal["ikplan", "ompl:RRTConnect", "ompl:AORRTC", "ompl:BITstar"], IfGiven()
    ] = Field(
        "ikplan",
        description="What searches for the way of a move: ikplan's own search, or a planner of "
        "OMPL, which has to be installed; `effort` is then the number of its iterations at most, "
        "all of which AORRTC and BIT* use for shorter ways.",
    )

    @model_validator(mode="after")
    def _affordable(self) -> IkOptions:
        # A search runs to its end, whatever the time budget: seconds at most, not hours.
        most = {"population": 100, "iterations": 1000}
        asked = [
            budget if isinstance(budget, int) else most[name] if budget == "paper" else 50
            for name, budget in (("population", self.population), ("iterations", self.iterations))
        ]
        population, iterations = asked
        if population * iterations > MAX_EVALUATIONS:
            raise ValueError(
                f"population times iterations must be at most {MAX_EVALUATIONS:,}, "
                f"not {population * iterations:,}"
            )
        looks = _LOOKS.get(self.method)
        if looks and population * iterations * (1 + population / looks) > MAX_EVALUATIONS:
            fewer = int(MAX_EVALUATIONS / (population * (1 + population / looks)))
            raise ValueError(
                f"in {self.method} all individuals look at each other: with a population of "
                f"{population:,}, at most {fewer:,} iterations are allowed, not {iterations:,}"
            )
        return self


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


class FkRequest(Document):
    """Joint values whose tool pose is asked for."""

    robot: str = Field(min_length=1, max_length=200, description="Name of a robot.")
    q: Floats = Field(description="Joint values, shape (dof,) [rad or m].")
    tool: Frame = Field(
        default_factory=Frame, description="The tool frame (TCP), in the tip frame."
    )


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


def json_schema() -> dict[str, Any]:
    """Return the JSON schema of the plan request, every default and unit included."""
    return PlanRequest.model_json_schema()
