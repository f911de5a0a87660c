"""A planar arm of two links whose answers are closed forms, and tool paths for it."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikplan.documents.poses import Tolerance
from ikplan.ik.solve import PoseSolver
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import no_freedom, pose_target
from ikplan.limits import JointLimits
from ikplan.path.tool_path import SegmentRange
from ikplan.planning import WaypointProblem
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.tracking.path_tracker import PathTracker
from ikplan.robots import Robot
from ikplan.time_budget import TimeBudget
from tests.kinematics.synthetic import Joint, robot_of

Array = NDArray[np.float64]
Elongation = Literal["global", "greedy"]

L1, L2 = 0.5, 0.4
REACH, HAND = L1 + L2, 0.2


def two_links(
    shoulder: tuple[float, float] = (-2.9, 2.9), elbow: tuple[float, float] = (-2.9, 2.9)
) -> Robot:
    """The arm, in the xy plane, with these limits [rad]; its joints are ``j1`` and ``j2``."""
    joints = [
        Joint("revolute", lower=float(shoulder[0]), upper=float(shoulder[1])),
        Joint("revolute", xyz=(L1, 0.0, 0.0), lower=float(elbow[0]), upper=float(elbow[1])),
    ]
    return robot_of(joints, tip=Joint("fixed", xyz=(L2, 0.0, 0.0)))


def level_hand(shoulder: tuple[float, float] = (-2.9, 2.9)) -> Robot:
    """The arm with a hand of 0.2 m on a third joint, which can hold it along x."""
    joints = [
        Joint("revolute", lower=float(shoulder[0]), upper=float(shoulder[1])),
        Joint("revolute", xyz=(L1, 0.0, 0.0)),
        Joint("revolute", xyz=(L2, 0.0, 0.0)),
    ]
    return robot_of(joints, tip=Joint("fixed", xyz=(HAND, 0.0, 0.0)))


def tool(q: ArrayLike) -> Array:
    """Where the tool is, shape (..., 3) [m]."""
    a, b = np.moveaxis(np.asarray(q, dtype=np.float64), -1, 0)
    x, y = (L1 * f(a) + L2 * f(a + b) for f in (np.cos, np.sin))
    return np.stack([x, y, np.zeros_like(x)], axis=-1)


def joints(p: ArrayLike, elbow: float) -> Array:
    """The configuration that has the tool at p, shape (..., 3), and an elbow of this sign."""
    p = np.asarray(p, dtype=np.float64)
    x, y = p[..., 0], p[..., 1]
    cosine = (x * x + y * y - L1 * L1 - L2 * L2) / (2.0 * L1 * L2)
    b = elbow * np.arccos(np.clip(cosine, -1.0, 1.0))
    a = np.arctan2(y, x) - np.arctan2(L2 * np.sin(b), L1 + L2 * np.cos(b))
    return np.stack([np.mod(a + np.pi, 2.0 * np.pi) - np.pi, b], axis=-1)


def level(p: ArrayLike, elbow: float) -> Array:
    """The configuration that has a hand along x at p, shape (..., 3)."""
    q = joints(np.asarray(p) - [HAND, 0.0, 0.0], elbow)
    return np.concatenate([q, -q.sum(axis=-1, keepdims=True)], axis=-1)


def positions(p: Array) -> Targets:
    """Targets of tool positions, shape (m, 3); no orientation counts."""
    m = len(p)
    R = np.broadcast_to(np.eye(3), (m, 3, 3)).copy()
    return Targets(R, p.copy(), np.zeros(m, dtype=bool), np.zeros(m), no_freedom())


@dataclass(frozen=True)
class Polyline:
    """Lines through points, the tool at rest at each corner; waypoints are the points."""

    points: Array
    taken: float = 0.0

    @property
    def _s(self) -> Array:
        steps = np.linalg.norm(np.diff(self.points, axis=0), axis=1)
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def length(self) -> float:
        return float(self._s[-1])

    @property
    def corners(self) -> Array:
        return self._s[1:-1]

    @property
    def waypoint_s(self) -> Array:
        return self._s[1:]

    @property
    def orientation_changes(self) -> Array:
        return np.empty(0)

    @property
    def segments(self) -> tuple[SegmentRange, ...]:
        return ()

    def poses(self, s: Array) -> tuple[Array, Array]:
        p = np.stack([np.interp(s, self._s, column) for column in self.points.T], axis=1)
        return np.broadcast_to(np.eye(3), (len(s), 3, 3)), p

    def positions(self, s: Array) -> Array:
        return self.poses(s)[1]

    def orientation_mask(self, s: Array) -> NDArray[np.bool_]:
        return np.full(len(s), False)


def line(*points: tuple[float, float]) -> Polyline:
    """Lines through points of the plane [m]."""
    return Polyline(np.array([[x, y, 0.0] for x, y in points]))


def tracker_of(robot: Robot, tolerance: float = 1e-4, budget_s: float = 1e6) -> PathTracker:
    """The arm as what is tracker_of along tool paths; positions alone count."""
    return PathTracker(
        arm_of(robot),
        JointLimits.from_robot(robot),
        no_freedom(),
        False,
        Tolerance(position=tolerance),
        TimeBudget(budget_s),
    )


def solver_of(robot: Robot) -> PoseSolver:
    """Solves single targets of an arm, exactly or not at all."""
    return PoseSolver(arm_of(robot), "lm", tolerance_position=1e-9, tolerance_orientation=1e-9)


WAYPOINTS = [(0.5, 0.2), (1.0, 0.5), (0.4, -0.3), (REACH + 5e-5, 0.0), (0.0, 1.3), (0.2, 0.6)]
"""Two of them, 1 and 4, are out of reach; 3 is too, by less than a tolerance of 0.1 mm."""


def problem_of(robot: Robot, **more: Any) -> WaypointProblem:
    """The waypoints as a problem, with other fields."""
    targets = [pose_target(np.array([x, y, 0.0])) for x, y in WAYPOINTS]
    start = joints([0.5, 0.0, 0.0], 1.0)
    problem = WaypointProblem(
        robot, solver_of(robot), targets, start, False, Tolerance(position=1e-4), TimeBudget(1e6)
    )
    return replace(problem, **more)
