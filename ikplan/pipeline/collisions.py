"""What of a request is checked for contact, and the proof on the finished motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

from ikplan.documents.clearance import Clearance, LeftContact
from ikplan.documents.scene import AttachedBody, Obstacle, Scene, ToolFrame, ToolGeometry
from ikplan.documents.shape import MeshShape
from ikplan.errors import InCollision, InvalidRequest
from ikplan.ik.solve import PoseSolver
from ikplan.robots import Robot
from ikplan.scene.body import CollisionModel
from ikplan.scene.model import collision_model
from ikplan.scene.resolve import resolve_geometry, resolve_scene

if TYPE_CHECKING:
    from ikplan.certificate.clearance import JointCurve
    from ikplan.certificate.clearance.leaving import Leaving
    from ikplan.collision.checker import CollisionChecker
    from ikplan.documents.plan_request import PlanRequest
    from ikplan.documents.requests.ik import IkBatchRequest, IkRequest
    from ikplan.documents.timing_request import TimingRequest
    from ikplan.pipeline.timing_stage import Timing

__all__ = ["handed_out", "keep_clear", "prove_motion", "requested_model", "with_meshes"]

R = TypeVar("R", "PlanRequest", "TimingRequest", "IkRequest", "IkBatchRequest")


def requested_model(
    robot: Robot,
    scene: Scene | str | None,
    fixed_joints: Mapping[str, float],
    tool: ToolFrame,
    *,
    always: bool,
) -> CollisionModel | None:
    """Return the bodies that a request asks to keep apart; None: it asks for no check.

    Args:
        robot: The robot, with the request's tool.
        scene: The scene of the request.
        fixed_joints: Values of joints beside the chain [rad or m].
        tool: The tool, with its shapes.
        always: Whether the arm is checked against itself where there is no scene.

    Raises:
        InvalidRequest: The scene names what does not exist.
        InvalidRobot: A shape of the robot makes no sense.
    """
    if scene is None and not always:
        return None
    if isinstance(scene, Scene):
        if not (scene.self_collision or scene.obstacles or scene.attached):
            return None
        scene = resolve_scene(scene, None)  # a file that is left is refused
    return collision_model(robot, scene, fixed_joints, tool.geometry)


def keep_clear(
    robot: Robot, solver: PoseSolver, model: CollisionModel | None, margin: float = 0.0
) -> CollisionChecker:
    """Make clearance what a solver looks for, and return the check of its bodies.

    Args:
        robot: The robot, with its tool.
        solver: The solver.
        model: The bodies; None: the request asks for no check.
        margin: Gap asked for on top of the clearance [m].

    Raises:
        InvalidRequest: There are no two bodies to keep apart.
    """
    if model is None:
        raise InvalidRequest(
            "ik.objective: clearance needs bodies to keep clear of: give a scene, {} for the arm "
            "against itself",
            field="ik.objective",
            allowed=["motion"],
        )
    if len(model.pairs) == 0:
        raise InvalidRequest(
            f"ik.objective: clearance needs two bodies at least that are to be kept apart; links "
            f"of {robot.name} without a shape: {', '.join(model.unchecked) or 'none'}",
            field="ik.objective",
            allowed=["motion"],
        )
    from ikplan.collision.checker import CollisionChecker

    contact = CollisionChecker(robot, model, margin)
    solver.keep_clear(contact.arrays(None))
    return contact


def with_meshes(request: R) -> R:
    """Return a request whose mesh files are read, relative to the working folder.

    Args:
        request: A request with or without a scene and shapes of the tool.

    Raises:
        InvalidRequest: A mesh cannot be read.
    """
    update: dict[str, Any] = {}
    if (read := _with_meshes(request.scene)) is not request.scene:
        update["scene"] = read
    if _has_mesh(request.tool.geometry):
        shapes = resolve_geometry(request.tool.geometry, Path.cwd())
        update["tool"] = request.tool.model_copy(update={"geometry": shapes})
    return request.model_copy(update=update) if update else request


def _with_meshes(scene: Scene | str | None) -> Scene | str | None:
    if isinstance(scene, Scene) and _has_mesh([*scene.obstacles, *scene.attached]):
        return resolve_scene(scene, Path.cwd())
    return scene


def _has_mesh(parts: Sequence[Obstacle | AttachedBody | ToolGeometry]) -> bool:
    return any(isinstance(part.shape, MeshShape) for part in parts)


def handed_out(timing: Timing) -> JointCurve:
    """Return a timed motion as it is handed out: its polynomials, or cubics between samples."""
    from ikplan.certificate.clearance import JointCurve

    if timing.motion is not None:
        return JointCurve.of_motion(timing.motion)
    samples = timing.samples
    return JointCurve.of_samples(samples.time, samples.q, samples.dq)


def prove_motion(
    robot: Robot,
    model: CollisionModel,
    timing: Timing,
    segment_times: Sequence[tuple[float, float]] | None = None,
    order: Sequence[int] | None = None,
    leaving: Leaving | None = None,
) -> Clearance:
    """Prove that a finished motion keeps the bodies of a model apart.

    Args:
        robot: The robot.
        model: The bodies and the clearance.
        timing: The timed motion, as it is handed out.
        segment_times: When each segment begins and ends, in the order passed [s]; None: every body
            is there throughout.
        order: Numbers of the segments in that order; None: as they are written.
        leaving: Pairs that touch at the start, and until when they may; None: none.

    Raises:
        CertificateViolated: What is carried over several segments is carried apart from them.
        InCollision: Bodies come nearer than allowed, or it cannot be told that they do not.
    """
    # Poses are checked too, without a proof.
    from ikplan.certificate.clearance import prove_clearance
    from ikplan.certificate.clearance.in_order import counted_in_order
    from ikplan.certificate.clearance.leaving import with_leaving

    curve = handed_out(timing)
    counted = model if order is None else counted_in_order(model, order)
    if leaving is not None:
        counted, segment_times = with_leaving(counted, leaving, segment_times, curve.duration)
    proof = prove_clearance(robot, counted, curve, segment_times=segment_times)
    violation, clearance = proof.violation, proof.clearance
    if leaving is not None:
        clearance = _left(clearance, model, leaving)
    if order is not None and clearance.segments:
        by_number = sorted(zip(order, clearance.segments, strict=True), key=lambda row: row[0])
        clearance = clearance.model_copy(update={"segments": [s for _, s in by_number]})
    if len(model.pairs) == 0:
        # Nothing is known of a robot without bodies.
        return clearance.model_copy(update={"proven": not model.unchecked})
    if violation is None:
        return clearance
    a, b = violation.pair
    depth = max(model.clearance - violation.gap, 0.0) + violation.depth
    if violation.undecided:
        what = f"it cannot be told whether {a} and {b} touch"
    elif violation.gap > 0.0:
        what = (
            f"{a} and {b} come within {violation.gap * 1e3:.3g} mm of each other, "
            f"{model.clearance * 1e3:.3g} mm are asked for"
        )
    else:
        what = f"{a} and {b} touch"
    raise InCollision(
        f"at {violation.time:.3f} s of the finished motion {what}",
        time=violation.time,
        pair=violation.pair,
        depth=depth,
        q=violation.q.tolist(),
        proven=not violation.undecided,
        reason=f"{a} and {b}",
    )


def _left(clearance: Clearance, model: CollisionModel, leaving: Leaving) -> Clearance:
    """A clearance that says what is left; the leaving is none of the request's segments."""
    names = [[model.bodies[k].name for k in model.pairs[row]] for row in leaving.rows]
    left = LeftContact(pairs=names, until=leaving.until)
    return clearance.model_copy(update={"left": left, "segments": clearance.segments[1:]})
