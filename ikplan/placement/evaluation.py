"""What a placement is worth: the planner is asked, and a refusal is graded."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NamedTuple

import numpy as np

from ikplan.arrays import Array
from ikplan.documents import parse
from ikplan.documents.plan_request import PlanRequest
from ikplan.errors import (
    CertificateViolated,
    Disconnected,
    IkplanError,
    InCollision,
    InvalidRequest,
    TimingFailed,
    Unreachable,
)
from ikplan.pipeline.plan import make_plan
from ikplan.pipeline.pose_batch.solve import solve_ik_batch
from ikplan.pipeline.resolve import resolve_robot
from ikplan.placement.moving import AXES, Moved, offset_of, replaced
from ikplan.planning.tracking.tracked_path import TrackingFailed
from ikplan.plans.plan import Plan
from ikplan.reach.along import PathPoses, poses_along
from ikplan.robots import Robot

__all__ = ["AIMS", "Aim", "Evaluated", "Site", "value_of"]

Aim = Literal["time", "motion", "wrist-speed"]
AIMS: tuple[Aim, ...] = ("time", "motion", "wrist-speed")
"""What is least: the duration [s]; the sum of what all joints move [rad or m]; the largest speed of
the last three joints [rad/s]."""
PLANNED, OUT_OF_REACH = "planned", "out-of-reach"
_POSES = 24
# Values of placements without a plan: above those of any plan, less where more is reached.
_REFUSED, _OUT_OF_REACH = 1e6, 2e6
_WRIST = 3


class Evaluated(NamedTuple):
    """A placement that was looked at.

    Attributes:
        values: Its values, in the order of the names [m or rad].
        outcome: "planned"; "out-of-reach": some poses of the path have no joint values; or the
            last part of the problem type of the planner's refusal.
        value: What it is worth, where there is a plan: duration [s], motion [rad or m] or speed
            [rad/s]; NaN elsewhere.
        reached: Share of the path that is reached; 1 with a plan.
        score: What a search minimises.
    """

    values: tuple[float, ...]
    outcome: str
    value: float
    reached: float
    score: float


@dataclass(frozen=True)
class Site:
    """A request whose part or base may be put elsewhere.

    Attributes:
        request: The request as it is given, with a scene that is no id and no file.
        robot: The robot of a file; None: that of the catalogue.
        move: "part" or "base".
        names: What may change, out of :data:`~ikplan.placement.moving.AXES`.
        lower: Lower bounds, shape (d,) [m or rad].
        upper: Upper bounds, shape (d,) [m or rad].
        aim: What is least.
        carried: Names of obstacles that move with the part.
    """

    request: PlanRequest
    robot: Robot | None
    move: Moved
    names: tuple[str, ...]
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    aim: Aim
    carried: tuple[str, ...] = ()

    def checked(self) -> Site:
        """Return itself.

        Raises:
            InvalidRequest: A name, a bound or an aim makes no sense, or the path has no tool path.
        """
        if not self.names:
            raise InvalidRequest("bounds: nothing may change", field="bounds", allowed=list(AXES))
        for name, low, high in zip(self.names, self.lower, self.upper, strict=True):
            if name not in AXES:
                raise InvalidRequest(
                    f"bounds.{name}: no such part of a placement",
                    field=f"bounds.{name}",
                    allowed=list(AXES),
                )
            if not (math.isfinite(low) and math.isfinite(high) and low <= high):
                raise InvalidRequest(
                    f"bounds.{name}: two finite numbers, the lower one first",
                    field=f"bounds.{name}",
                )
        for field, value, allowed in (
            ("move", self.move, ["part", "base"]),
            ("minimise", self.aim, list(AIMS)),
        ):
            if value not in allowed:
                raise InvalidRequest(
                    f"{field}: one of {', '.join(allowed)}, not {value!r}",
                    field=field,
                    allowed=allowed,
                )
        self.at(np.zeros(len(self.names)))
        self.along()
        return self

    def along(self) -> PathPoses:
        """Poses along the path as it is given."""
        return poses_along(self.request, resolve_robot(self.request, self.robot), _POSES)

    def motion(self, values: Sequence[float] | Array) -> tuple[Array, Array]:
        """Return the motion of a placement; a part turns about the middle of its path."""
        pivot = np.zeros(3)
        if self.move == "part":
            p = self.along().positions
            pivot = (p.min(axis=0) + p.max(axis=0)) / 2.0
        return offset_of(self.names, [float(v) for v in values], pivot)

    def at(self, values: Sequence[float] | Array) -> dict[str, Any]:
        """Return the document of the request at a placement."""
        return replaced(self.request, self.move, *self.motion(values), self.carried)

    def plan(self, values: Sequence[float] | Array, *, repairs: bool = True) -> Plan:
        """Plan the path at a placement; see :func:`ikplan.plan` for what it raises."""
        return make_plan(parse(PlanRequest, self.at(values)), self.robot, repairs=repairs)

    def evaluate(self, values: Sequence[float] | Array) -> Evaluated:
        """Look at a placement.

        First joint values are sought for poses along the path, each for itself. Only where all
        have some the path is planned.
        """
        given = tuple(float(v) for v in values)
        reached = self.reach([given])[0]
        if reached < 1.0:
            score = _OUT_OF_REACH + _REFUSED * (1.0 - reached)
            return Evaluated(given, OUT_OF_REACH, math.nan, reached, score)
        try:
            found = self.plan(given, repairs=False)
        except CertificateViolated:
            raise  # a fault of ours
        except TrackingFailed as error:  # of a planner that does not explain itself
            share = min(error.s / max(self._length(), 1e-9), 1.0)
            score = _REFUSED * (2.0 - share)
            return Evaluated(given, Disconnected.slug, math.nan, share, score)
        except IkplanError as error:
            share = _share(error, self._count())
            return Evaluated(given, error.slug, math.nan, share, _REFUSED * (2.0 - share))
        value = value_of(found, self.aim)
        return Evaluated(given, PLANNED, value, 1.0, value)

    def reach(self, placements: Sequence[Sequence[float]] | Array) -> list[float]:
        """Return the share of poses along the path that have joint values, of each placement."""
        poses = self.along()
        robot = resolve_robot(self.request, self.robot)
        oriented = poses.oriented
        hits = np.zeros((len(placements), len(oriented)), dtype=np.bool_)
        moved = [self.motion(values) for values in placements]
        if self.move == "base":
            moved = [(R.T, -R.T @ p) for R, p in moved]
        T = np.tile(np.eye(4), (len(placements), len(oriented), 1, 1))
        for k, (R, p) in enumerate(moved):
            T[k, :, :3, :3] = R @ poses.rotations
            T[k, :, :3, 3] = poses.positions @ R.T + p
        seed = self.request.ik.seed
        if oriented.any():
            found = solve_ik_batch(
                robot, T[:, oriented].reshape(-1, 4, 4), seed=seed, verdict=False, threads=1
            )
            hits[:, oriented] = found.solved.reshape(len(placements), -1)
        if not oriented.all():
            free = T[:, ~oriented, :3, 3].reshape(-1, 3)
            found = solve_ik_batch(robot, free, seed=seed, verdict=False, threads=1)
            hits[:, ~oriented] = found.solved.reshape(len(placements), -1)
        return [float(share) for share in hits.mean(axis=1)]

    def _length(self) -> float:
        """Length of the path, about [m]."""
        p = self.along().positions
        return float(np.linalg.norm(np.diff(p, axis=0), axis=1).sum())

    def _count(self) -> int:
        path = self.request.path
        return len(path.segments or path.waypoints or ())

    def with_scene_read(self) -> Site:
        """Return itself with the files of its scene read."""
        from ikplan.pipeline.collisions import with_meshes

        return replace(self, request=with_meshes(self.request))


def value_of(plan: Plan, aim: Aim) -> float:
    """Return what a plan is worth."""
    if aim == "time":
        return float(plan.duration)
    if aim == "motion":
        return float(np.abs(np.diff(plan.q, axis=0)).sum())
    return float(np.abs(plan.dq[:, -_WRIST:]).max())


def _share(error: IkplanError, count: int) -> float:
    """About what share of the path is reached before a refusal."""
    if isinstance(error, Unreachable):
        done = float(error.waypoint)
    elif isinstance(error, Disconnected):
        done = float(max(min(error.waypoints), 0))
    elif isinstance(error, InCollision) and error.waypoint is not None:
        done = float(max(error.waypoint, 0))
    elif isinstance(error, TimingFailed) and error.position is not None:
        return min(max(float(error.position), 0.0), 1.0)
    else:
        return 0.0
    return min(done / max(count, 1), 1.0)
