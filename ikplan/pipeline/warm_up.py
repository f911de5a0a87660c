"""Small requests that load, or compile, the kernels before anybody waits for an answer."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Mapping
from typing import Any, Literal

import pinocchio as pin

from ikplan.errors import InCollision, Unreachable
from ikplan.ik.registry import find_solver
from ikplan.robots import Robot, catalogue_robot

__all__ = ["RequestKind", "small_requests", "warm_up"]

RequestKind = Literal["fk", "ik", "ik-batch", "plan", "time"]

_ROBOT = "xarm7"
"""A robot with self-motion and inertias: its requests use the kernels of both."""
_WRIST = "iiwa14"
"""A robot with a spherical wrist."""
_BRANCHES = "ur5"
"""A robot with a closed form, and inertias."""
_LIMITS = {"jerk": False, "tool_speed": 1.0, "tool_acceleration": 50.0, "torque": True}
_BUDGET_S = 3600.0
_lock = threading.RLock()
_under_way: set[tuple[RequestKind, str, bool, bool]] = set()
_ready: set[tuple[RequestKind, str, bool, bool]] = set()


def warm_up(
    run: Callable[[Mapping[str, Any]], object],
    kind: RequestKind,
    method: str = "ik-ba",
    *,
    jerk: bool = False,
    moves: bool = False,
) -> None:
    """Make every kernel that requests of a kind use ready, once a process.

    For a service, and for processes that are forked: a request by itself compiles and loads what
    it uses, outside its budget. Compiling takes tens of seconds on the first use after an
    installation; loading what was compiled takes about a second.

    Args:
        run: Answers a request of this kind. It may warm up itself: within a warm-up, a further
            one of the same kind does nothing.
        kind: Which requests.
        method: Name of the solver that they use.
        jerk: Whether those with limits of jerks too.
        moves: Whether those with moves around obstacles too.

    Raises:
        InvalidRequest: No solver of that name.
    """
    if jerk or moves:
        warm_up(run, kind, method, jerk=jerk and moves)
    key = (kind, method, jerk, moves)
    if key in _ready:
        return
    with _lock:  # a second thread waits for the first
        if key in _ready or key in _under_way:
            return
        _under_way.add(key)
        try:
            asked = _moves(method) if moves else small_requests(kind, method, jerk=jerk)
            if kind == "plan" and not moves:
                _turns(catalogue_robot(_robot(method)))
            for request in asked:
                # Some are out of reach or in contact: the explanation has kernels of its own.
                with contextlib.suppress(Unreachable, InCollision):
                    run(request)
        finally:
            _under_way.discard(key)
        _ready.add(key)


def small_requests(
    kind: RequestKind, method: str = "ik-ba", *, jerk: bool = False
) -> list[dict[str, Any]]:
    """Return requests of a kind that use, between them, every kernel that others of it use.

    Args:
        kind: Which requests.
        method: Name of the solver that they use.
        jerk: Those with limits of jerks, on top of those without.

    Raises:
        InvalidRequest: No solver of that name.
    """
    home = catalogue_robot(_ROBOT).home.tolist()
    if kind == "fk":
        return [{"robot": _ROBOT, "q": home}]
    if kind == "ik":
        return _poses(method)
    if kind == "ik-batch":
        poses = [*_targets(catalogue_robot(_robot(method)))[1:]]
        options = {"ik": {"method": method}, "budget_s": _BUDGET_S, "verdict": False}
        return [{"robot": _robot(method), "poses": poses, **options}]
    limits = [{**_LIMITS, "jerk": 100.0}] if jerk else [_LIMITS, {"jerk": False}]
    if kind == "time":
        waypoints = [home, [value + 0.1 for value in home]]
        timed = {"robot": _ROBOT, "waypoints": waypoints, "budget_s": _BUDGET_S}
        requests = [{**timed, "limits": each} for each in limits]
        if not jerk:
            tool = catalogue_robot(_ROBOT).fk(home).translation.tolist()
            requests += [{**requests[-1], "scene": scene} for scene in _scenes(tool)]
            requests.append(_with_many_rests(timed))
        return requests
    paths = _paths(method)
    limited = [{**paths[0], "limits": each} for each in limits]
    return limited if jerk else [*limited, *paths[1:]]


def _with_many_rests(timed: dict[str, Any]) -> dict[str, Any]:
    """A motion to and fro that rests so often that the spans between are timed together."""
    from ikplan.timing.time_joint_path import MANY_RESTS

    count = MANY_RESTS + 2
    return {
        **timed,
        "waypoints": [timed["waypoints"][k % 2] for k in range(count)],
        "rest_at": list(range(count)),
        "limits": {"jerk": False},
    }


def _turns(robot: Robot) -> None:
    """Look for full turns of a solution: requests do where a waypoint is past a limit by a hair."""
    from ikplan.kinematics.arm import arm_of
    from ikplan.planning.ladder.equivalent_configurations import with_equivalents

    with_equivalents(arm_of(robot), robot.home[None])


def _robot(method: str) -> str:
    """A robot that a method solves."""
    return _BRANCHES if method == "closed-form" else _ROBOT


def _targets(robot: Robot) -> tuple[dict[str, Any], dict[str, Any], dict[str, Any]]:
    """A position, a pose, and a pose that is out of reach."""
    pose = pin.SE3ToXYZQUAT(robot.fk(robot.home + 0.05)).tolist()
    full = {"position": pose[:3], "quaternion_xyzw": pose[3:]}
    return {"position": pose[:3]}, full, {**full, "position": [9.0, 0.0, 0.0]}


def _scenes(place: list[float]) -> tuple[dict[str, Any], dict[str, Any]]:
    """A scene far from a place, and one with an obstacle there."""
    ball = {"name": "ball", "shape": {"type": "sphere", "radius": 0.1}}
    far = {**ball, "position": [0.0, 0.0, 9.0]}
    return {"obstacles": [far]}, {"obstacles": [{**ball, "position": place}]}


def _moves(method: str) -> list[dict[str, Any]]:
    """Moves around a box that is midway between their ends, anywhere and within a region."""
    robot = catalogue_robot(_robot(method))
    goal, middle = robot.home.copy(), robot.home.copy()
    goal[0], middle[0] = robot.home[0] + 1.0, robot.home[0] + 0.5
    box = {
        "name": "box",
        "shape": {"type": "box", "size": [0.05, 0.05, 0.05]},
        "position": robot.fk(middle).translation.tolist(),
    }
    asked = {
        "robot": _robot(method),
        "start": robot.home.tolist(),
        "scene": {"obstacles": [box]},
        "ik": {"method": method},
        "limits": {"jerk": False},
        "budget_s": _BUDGET_S,
    }
    free = {"type": "move", "q": goal.tolist()}
    wide = {"frame": {"position": [0.0, 0.0, 0.0]}, "size": [5.0, 5.0, 5.0]}
    segments = (free, {**free, "within": {"box": wide}})
    return [{**asked, "path": {"segments": [segment]}} for segment in segments]


def _poses(method: str) -> list[dict[str, Any]]:
    """What is asked for of a single pose."""
    robot = catalogue_robot(_robot(method))
    point, full, far = _targets(robot)
    asked: dict[str, Any] = {
        "robot": _robot(method),
        "ik": {"method": method},
        "budget_s": _BUDGET_S,
    }
    start = robot.home.tolist()
    requests = [{**asked, **target} for target in (point, full, far)]
    requests += [{**asked, **target, "start": start} for target in (point, full)]
    scenes = _scenes(point["position"])
    requests += [{**asked, **full, "scene": scene} for scene in scenes]
    known = {**asked, "robot": _BRANCHES}
    requests += [{**known, **target} for target in _targets(catalogue_robot(_BRANCHES))]
    if any(parameter.name == "decouple" for parameter in find_solver(method).parameters):
        _, full, _ = _targets(catalogue_robot(_WRIST))
        ik = {"method": method, "params": {"decouple": True}}
        requests.append({**asked, "robot": _WRIST, **full, "ik": ik})
    return requests


def _blocked_line(robot: Robot) -> dict[str, Any]:
    """A line at whose end is a ball: every way around it is looked for."""
    goal = robot.home.copy()
    goal[0] += 1.0
    pose = pin.SE3ToXYZQUAT(robot.fk(goal)).tolist()
    waypoint = {"position": pose[:3], "quaternion_xyzw": pose[3:]}
    return {
        "start": robot.home.tolist(),
        "path": {"waypoints": [waypoint], "interpolation": "line"},
        "scene": _scenes(pose[:3])[1],
    }


def _paths(method: str) -> list[dict[str, Any]]:
    """What is asked for of a path; of the first, under several limits."""
    robot = catalogue_robot(_robot(method))
    point, full, far = _targets(robot)
    near = {"position": [value + 0.01 for value in point["position"]]}
    asked: dict[str, Any] = {
        "robot": _robot(method),
        "path": {"waypoints": [full, near]},
        "ik": {"method": method},
        "limits": {"jerk": False},
        "budget_s": _BUDGET_S,
    }
    start = robot.home.tolist()
    return [
        asked,
        {**asked, "path": {"waypoints": [point]}, "start": start},
        {**asked, "path": {"waypoints": [full]}, "start": "free"},
        {**asked, "ik": {"method": method, "elongation": "greedy"}},
        {**asked, "path": {**asked["path"], "interpolation": "line"}},
        {**asked, "path": {**asked["path"], "interpolation": "line"}, "start": "free"},
        {**asked, "path": {"waypoints": [point]}, "scene": _scenes(point["position"])[1]},
        {**asked, **_blocked_line(robot)},
        {**asked, "path": {**asked["path"], "interpolation": "spline"}},
        {**asked, "path": {"waypoints": [far]}},
        *_branches(method),
    ]


def _branches(method: str) -> list[dict[str, Any]]:
    """Paths of a robot with a closed form, whose branches are candidates: within reach and out."""
    _, full, far = _targets(catalogue_robot(_BRANCHES))
    asked: dict[str, Any] = {
        "robot": _BRANCHES,
        "ik": {"method": method},
        "budget_s": _BUDGET_S,
    }
    asked["limits"] = {"jerk": False}
    return [{**asked, "path": {"waypoints": waypoints}} for waypoints in ([full], [far, full])]
