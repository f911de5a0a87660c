"""What is checked for contact, drawn: clearance over time, obstacles, the nearest two bodies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from numpy.typing import NDArray
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection, QhullError

from ikplan.plans.clearance_samples import clearance_over_time
from ikplan.plans.figures.style import COLOURS
from ikplan.scene.poses import carrier_poses

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot
    from ikplan.scene.body import CollisionModel, ConvexPiece

__all__ = ["draw_bodies", "draw_clearance"]

Array = NDArray[np.float64]

_ROUND = np.array(
    [
        (i, j, k)
        for i in (-1, 0, 1)
        for j in (-1, 0, 1)
        for k in (-1, 0, 1)
        if (i, j, k) != (0, 0, 0)
    ]
)
_DIRECTIONS = _ROUND / np.linalg.norm(_ROUND, axis=1)[:, None]


def draw_clearance(
    axes: Axes, plan: PlanDocument, robot: Robot | None, model: CollisionModel | None
) -> None:
    """Draw the distances over time, what is proven of them, and what was asked for."""
    clearance = plan.certificate.clearance
    assert clearance is not None
    parts = (("arm from itself", clearance.self_, False), ("from obstacles", clearance.scene, True))
    for k, (label, place, outside) in enumerate(parts):
        if place.least is None or place.time is None:
            continue
        part = None if model is None else _pairs_of(model, outside=outside)
        if robot is not None and part is not None and len(part.pairs):
            time, distance = clearance_over_time(plan, robot, part)
            axes.plot(time, 1e3 * distance, color=COLOURS[k], label=label)
        axes.axhline(1e3 * place.least, color=COLOURS[k], lw=1.0, ls=(0, (4, 3)))
        axes.plot([place.time], [1e3 * (place.found or 0.0)], "o", ms=5, color=COLOURS[k])
    if clearance.clearance > 0.0:
        axes.axhline(1e3 * clearance.clearance, color="#B00020", lw=1.0, label="asked for")
    axes.set_ylim(bottom=0.0)
    axes.set_title("Clearance, dashed: proven")
    axes.set_ylabel("distance [mm]")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="upper right", ncols=3)


def _pairs_of(model: CollisionModel, *, outside: bool) -> CollisionModel:
    """A model with its pairs with obstacles only, or with the others only."""
    obstacle = np.array([body.kind == "obstacle" for body in model.bodies], dtype=np.bool_)
    return replace(model, pairs=model.pairs[obstacle[model.pairs].any(axis=1) == outside])


def draw_bodies(
    axes: Any, plan: PlanDocument, robot: Robot, model: CollisionModel, low: Array, high: Array
) -> None:
    """Draw obstacles, and the nearest two bodies with the line between them, in a box.

    Args:
        axes: Axes in three dimensions.
        plan: The plan.
        robot: The robot, with its tool.
        model: The bodies.
        low: Lower corner of what is shown, shape (3,) [m].
        high: Upper corner, shape (3,) [m].
    """
    clearance = plan.certificate.clearance
    names = {body.name for body in model.bodies}
    near = clearance is not None and clearance.pair is not None and set(clearance.pair) <= names
    pair = clearance.pair if clearance is not None and clearance.pair is not None and near else []
    time = clearance.time if clearance is not None and near else None
    row = int(np.argmin(np.abs(plan.trajectory.time - (time or 0.0))))
    R, p = carrier_poses(robot, plan.trajectory.q[row])
    for body in model.bodies:
        if body.kind != "obstacle" and body.name not in pair:
            continue
        colour = COLOURS[1] if body.name in pair else "#888888"
        for piece in body.pieces:
            points = _outline(piece) @ R[body.carrier].T + p[body.carrier]
            faces = _faces(points, low, high)
            if len(faces):
                axes.add_collection3d(
                    Poly3DCollection(faces, facecolor=colour, alpha=0.16, edgecolor="none")
                )
    if clearance is not None and near and clearance.points is not None:
        ends = np.array(clearance.points)
        axes.plot(*ends.T, "-", color="#B00020", lw=2.0, label="nearest")


def _outline(piece: ConvexPiece) -> Array:
    """Points whose hull stands for a piece in a picture."""
    if piece.radius <= 0.0:
        return np.asarray(piece.points)
    ball = piece.radius * _DIRECTIONS
    outline: Array = (piece.points[:, None, :] + ball).reshape(-1, 3)
    return outline


def _faces(points: Array, low: Array, high: Array) -> Array:
    """Triangles of the hull of points, cut off at a box, shape (n, 3, 3)."""
    none = np.empty((0, 3, 3))
    try:
        hull = ConvexHull(points)
        if (points.min(axis=0) >= low).all() and (points.max(axis=0) <= high).all():
            shown: Array = points[hull.simplices]
            return shown
        sides = np.vstack([np.eye(3), -np.eye(3)])
        box = np.column_stack([sides, np.concatenate([-high, low])])
        halves = np.vstack([hull.equations, box])
        # The centre of the largest ball in both: qhull needs a point inside.
        reach = np.linalg.norm(halves[:, :3], axis=1)
        A = np.column_stack([halves[:, :3], reach])
        found = linprog(
            [0.0, 0.0, 0.0, -1.0],
            A_ub=A,
            b_ub=-halves[:, 3],
            bounds=[(None, None)] * 3 + [(0, None)],
        )
        if found.x is None or found.x[3] < 1e-6:
            return none
        corners = HalfspaceIntersection(halves, found.x[:3]).intersections
        cut: Array = corners[ConvexHull(corners).simplices]
        return cut
    except QhullError:  # flat: nothing to be seen of it
        return none
