"""What is refused of a tool path, before it is tracked and where that fails."""

from __future__ import annotations

from ikplan.errors import InvalidRequest, NoPlan
from ikplan.kinematics.target import Freedom
from ikplan.path import ToolPath
from ikplan.planning.joint_route import JointPathProblem
from ikplan.planning.segment_number import segment_number
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.planning.tracking.tracking_failure import explain_tracking_failure
from ikplan.planning.waypoints.in_collision import motion_in_collision

__all__ = ["check_box", "tracking_verdict"]


def tracking_verdict(
    problem: JointPathProblem, tracker: PathTracker, path: ToolPath, failure: TrackingFailed
) -> NoPlan:
    """Return why a tool path cannot be tracked to its end."""
    if failure.contact is None or problem.contact is None:
        return explain_tracking_failure(problem.robot, problem.solver, tracker, path, failure)
    after = next((w.row for w in path.waypoints if w.s >= failure.s), path.waypoints[-1].row)
    where = f"{failure.s * 1e3:.1f} mm of {path.length * 1e3:.1f} mm along the path"
    part = next((x for x in path.segments if x.begin <= failure.s <= x.end), None)
    segment = None if part is None else segment_number(part.field)
    subject = f"the path to waypoint {after}, {where}"
    return motion_in_collision(problem.contact, failure.contact, after, subject, segment)


def check_box(freedom: Freedom, path: ToolPath) -> None:
    """Refuse a box whose axes are known on a part of the path only.

    Raises:
        InvalidRequest: They are.
    """
    if not (freedom.boxed and freedom.in_tool and freedom.box[:3].any()):
        return
    told = [piece.oriented for piece in path.pieces] + [w.R is not None for w in path.waypoints]
    if any(told) and not all(told):
        raise InvalidRequest(
            "path.tolerance.box.frame: part of the path asks for no orientation, and with it "
            'the axes of the tool are not told for the box: choose "path"',
            field="path.tolerance.box.frame",
            allowed=["path"],
        )
