"""A program of points read back and played, beside the plan and the certificate it comes with."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from benchmarks.programs import drl, fanuc, franky, krl, rapid, xarm
from ikplan.plans.export import as_drl, as_fanuc, as_krl, as_rapid, as_xarm, encode
from ikplan.plans.export.formats import Arm
from ikplan.plans.export.program_text import points_of
from ikplan.plans.plan import Plan
from ikplan.plans.programs.certificate import ProgramCertificate
from ikplan.plans.programs.certifying import limits_of
from ikplan.plans.programs.times import ANY_TIMES
from ikplan.plans.programs.waypoints import CYCLE, waypoints
from ikplan.robots import Robot

__all__ = ["PLAYERS", "Judged", "judge"]

Array = NDArray[np.float64]

PLAYERS = {
    "rapid": ("blended", as_rapid.stored, 0.004, ANY_TIMES, 4),
    "krl": ("spline", as_krl.stored, 0.012, ANY_TIMES, 4),
    "fanuc-ls": ("blended", as_fanuc.stored, 0.008, as_fanuc.TIMES, 3),
    "drl": ("blended", as_drl.stored, 0.001, ANY_TIMES, 4),
    "xarm": ("spline", as_xarm.stored, as_xarm.CYCLE, ANY_TIMES, 4),
}
"""What each controller does between points, what it stores, its cycle [s], the times of
its steps and the decimals of its degrees."""
_FINE = 1e-3
# Lines between places of the path one millisecond apart are this close to it, and closer.
_CLOSE = 3e-6


@dataclass(frozen=True)
class Judged:
    """What a played program does.

    Attributes:
        certificate: What its certificate says.
        duration: How long it takes [s].
        deviation: Largest distance of the tool from the plan's path, at any cycle [m].
        velocity: Largest share of a joint's speed limit, from cycle to cycle.
        acceleration: The same of the acceleration limits.
        ends: How far the joints end from the plan's end [rad].
        resolution: Last decimal of the joint values in the program [rad].
    """

    certificate: ProgramCertificate
    duration: float
    deviation: float
    velocity: float
    acceleration: float
    ends: float
    resolution: float

    @property
    def kept(self) -> bool:
        """Whether the motion is within the bounds that the certificate names."""
        c = self.certificate
        return (
            abs(self.duration - c.duration) <= 1e-5 * max(c.duration, 1.0)
            and self.deviation <= c.max_path_deviation + _CLOSE
            and c.max_path_deviation <= c.tolerance
            and self.velocity <= c.velocity_limit_ratio * (1.0 + 1e-4) + 1e-9
            and self.acceleration <= c.acceleration_limit_ratio * (1.0 + 1e-3) + 1e-6
            and max(c.velocity_limit_ratio, c.acceleration_limit_ratio) <= 1.0 + 1e-9
            and self.ends <= 1.1 * self.resolution
        )


def judge(plan: Plan, robot: Robot, language: str, limits: tuple[Array, Array]) -> Judged:
    """Write a plan as a program, play it, and measure.

    Args:
        plan: The plan.
        robot: Its robot.
        language: One of PLAYERS.
        limits: Joint velocities and accelerations that the plan was made for.
    """
    if language == "franky":
        return _waypoints(plan, robot)
    kind, stored, cycle, times, digits = PLAYERS[language]
    arm = Arm.of_plan(plan)
    known = arm.controller
    found = known.language(language) if known is not None else None
    if language == "xarm":
        found = as_xarm.language(arm)
    assert found is not None
    made = points_of(plan, found, kind, stored, robot, times=times)  # type: ignore[arg-type]
    text = encode(plan, language, robot=robot).decode("ascii")
    matrix = np.eye(robot.dof) if found.joints is None else np.array(found.joints)
    back = np.linalg.inv(matrix).T

    def way(a: Array, b: Array) -> float:
        places = robot.poses(np.radians(np.array([a, b])) @ back)[1]
        return float(1e3 * np.linalg.norm(places[1] - places[0]))

    if language in ("rapid", "drl"):
        played = (rapid if language == "rapid" else drl).play(text, cycle, way)
    else:
        player = {"krl": krl.play, "fanuc-ls": fanuc.play, "xarm": xarm.play}[language]
        played = player(text, cycle)
    q = np.radians(played.degrees) @ back
    # The arm is at the end when its time is over, in the middle of a cycle or not.
    whole = q[:-1] if played.time[-1] - played.time[-2] < cycle * (1.0 - 1e-9) else q
    return _judged(
        plan,
        robot,
        made.certificate,
        q,
        whole,
        cycle,
        float(played.time[-1]),
        limits,
        10.0**-digits,
    )


def _waypoints(plan: Plan, robot: Robot) -> Judged:
    """A franky program, played by franky's stand-in."""
    assert robot.jerk_limit is not None
    most = np.array([robot.velocity_limit, robot.acceleration_limit, robot.jerk_limit])
    text = encode(plan, "franky", robot=robot).decode("ascii")
    played = franky.play(text, most)
    certificate = waypoints(plan, robot).certificate
    q, duration = played.q, played.reached * CYCLE
    limits = limits_of(plan, robot)
    return _judged(plan, robot, certificate, q, q, CYCLE, duration, limits, np.degrees(1e-6))


def _judged(
    plan: Plan,
    robot: Robot,
    certificate: ProgramCertificate,
    q: Array,
    whole: Array,
    cycle: float,
    duration: float,
    limits: tuple[Array, Array],
    resolution: float,
) -> Judged:
    """Measure joint values of whole cycles; ``q`` has the end too, ``resolution`` is in deg."""
    path = robot.poses(plan.at(np.arange(0.0, plan.duration + _FINE, _FINE))[0])[1]
    rest = np.repeat(whole[:1], 2, axis=0)
    speeds = np.diff(np.vstack([rest, whole]), axis=0) / cycle
    changes = np.diff(speeds, axis=0) / cycle
    return Judged(
        certificate=certificate,
        duration=duration,
        deviation=float(_from_path(robot.poses(q)[1], path).max()),
        velocity=float((np.abs(speeds) / limits[0]).max()),
        acceleration=float((np.abs(changes) / limits[1]).max()),
        ends=float(np.abs(q[-1] - plan.q[-1]).max()),
        resolution=float(np.radians(resolution)),
    )


def _from_path(places: Array, path: Array) -> Array:
    """Distances of places from the lines between the places of a path [m]."""
    # Of a path that crosses itself, places near by belong to another part of it.
    _, nearest = cKDTree(path).query(places, k=min(8, len(path)))
    found = np.full(len(places), np.inf)
    for column in np.atleast_2d(nearest).T:
        for begin in (np.maximum(column - 1, 0), np.minimum(column, len(path) - 2)):
            a, line = path[begin], path[begin + 1] - path[begin]
            length = np.maximum((line * line).sum(axis=1), 1e-30)
            x = np.clip(((places - a) * line).sum(axis=1) / length, 0.0, 1.0)
            found = np.minimum(found, np.linalg.norm(places - a - x[:, None] * line, axis=1))
    return found
