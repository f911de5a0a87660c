"""A helper that compiles kernels beside a process that waits for them.

Started as a module, with kind of the requests, name of the solver, 1 for limits of jerks, 1 for
limits of torques or of the tool, number of this helper and how many there are. It runs small
requests of the kind, those first that use what a request uses last, so that it meets the process
that it helps in the middle. Kernels that are being compiled elsewhere are waited for, not compiled
twice.
"""

from __future__ import annotations

import contextlib
import os
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from ikplan._jit import cache_folder
from ikplan._kernels.turns import Turn
from ikplan.certificate.offsets import Allowance
from ikplan.collision.checker import CollisionChecker
from ikplan.documents.path import PathRequest
from ikplan.errors import IkplanError
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import ORIENTATION_WEIGHT, no_freedom
from ikplan.pipeline.plan import plan
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.retime import time_request
from ikplan.pipeline.warm_up import small_requests
from ikplan.planning.ladder.ik_candidates import Targets
from ikplan.planning.ladder.motion_cost import plain_cost
from ikplan.planning.ladder.path_shortening import shorten_sequence
from ikplan.robots import catalogue_robot
from ikplan.scene.model import collision_model

__all__ = ["main"]

Run = Callable[[Mapping[str, Any]], object]


def main(arguments: Sequence[str]) -> None:
    """Compile what requests of a kind use.

    Args:
        arguments: Kind of the requests, name of the solver, 1 for limits of jerks, 1 for limits of
            torques or of the tool, the number of this helper and how many there are.
    """
    kind, method, jerk, loads, number, count = arguments
    parent = os.getppid()  # 1 in a container whose only command waits for it
    try:
        turn = Turn(cache_folder() / f"helper-{number}.lock")
    except OSError:
        return  # another process has its helpers already, or nothing can be kept
    try:
        work = _work(kind, method, jerk == "1", loads == "1")
        first = len(work) * int(number) // int(count)
        for run, request in (*work[first:], *work[:first]):
            with contextlib.suppress(IkplanError):
                run(request)
            if os.getppid() != parent:
                return  # nobody waits any more
    finally:
        turn.give_back()


def _work(kind: str, method: str, jerk: bool, loads: bool) -> list[tuple[Run, dict[str, Any]]]:
    """Small requests, and what runs them."""
    if kind == "ik":
        return [(solve_ik_request, request) for request in small_requests("ik", method)]
    (timing, *_) = _as_asked(small_requests("time", jerk=jerk), loads)
    if kind == "time":
        return [(time_request, timing)]
    # Timing, certificate and the proof of no contact come last in a plan, before them the checks,
    # and before these the shortening of sequences.
    checked: dict[str, Any] = {"scene": {"self_collision": True}}
    (asked, *_) = _as_asked(small_requests("plan", method, jerk=jerk), loads)
    return [
        (time_request, {**timing, **checked}),
        (_check, timing),
        (_shorten, timing),
        (plan, asked),
    ]


def _as_asked(requests: list[dict[str, Any]], loads: bool) -> list[dict[str, Any]]:
    """Return the requests with limits of torques and of the tool, or those without; else all."""
    chosen = [each for each in requests if ("torque" in each["limits"]) == loads]
    return chosen or requests


def _check(request: Mapping[str, Any]) -> None:
    """Check waypoints, and the motions between them, as planning does."""
    robot = catalogue_robot(request["robot"])
    s, q = np.arange(2.0), np.array(request["waypoints"])
    checker = CollisionChecker(robot, collision_model(robot, None))
    checker.first_contact(q)
    for each in (s, q):
        each.setflags(write=False)  # as in the motions that planning checks
    checker.contacts_on_curve(s, q, (q[:1], q[1:]), None, 0.0)


def _shorten(request: Mapping[str, Any]) -> None:
    """Shorten a sequence, as planning does, and measure its waypoints, as the certificate does."""
    robot = catalogue_robot(request["robot"])
    arm, q = arm_of(robot), np.array(request["waypoints"])
    poses = [robot.fk(each) for each in q]
    p, R = (
        np.array([each.translation for each in poses]),
        np.array([each.rotation for each in poses]),
    )
    oriented, weight = np.ones(len(q), dtype=np.bool_), np.full(len(q), ORIENTATION_WEIGHT)
    targets = Targets(R, p, oriented, weight, no_freedom())
    path = PathRequest.model_validate({"waypoints": [{"position": each.tolist()} for each in p]})
    Allowance(path).offsets(p, R, p, R, oriented)
    cost, start = plain_cost(robot.dof), q[0].copy()
    shorten_sequence(arm.chain, targets, q, start, False, arm.lower, arm.upper, cost, 1, 1.0)


if __name__ == "__main__":
    main(sys.argv[1:])
