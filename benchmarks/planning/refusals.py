"""Random refusals, held to an independent solver and tracker, and their repairs, each planned.

Unreachable is held to many restarts, Disconnected to a dense tracker from many branches.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

import ikplan
from benchmarks.planning.judge import followed_from
from benchmarks.requests.drawing import draw
from benchmarks.speed.measure import Figure
from ikplan.ik.levenberg_marquardt import Effort, refine
from ikplan.ik.workspace import new_workspace
from ikplan.kinematics.arm import arm_of
from ikplan.kinematics.target import Target, pose_target
from ikplan.path import rotation_of
from ikplan.pipeline.resolve import resolve_robot
from ikplan.planning.repair_kinds import merged_document
from ikplan.planning.task_freedom import freedom_of
from ikplan.robots import Robot

__all__ = ["figures", "reached"]

Array = NDArray[np.float64]

SEED = 15
RESTARTS = 3000
BUDGET_S = 60.0
_TELL = 50
"""After how many requests what has come out so far is printed."""


def reached(robot: Robot, target: Target, position: float, orientation: float) -> bool:
    """Return whether one of many restarts comes within a tolerance of a target."""
    arm, rng = arm_of(robot), np.random.default_rng(SEED)
    home = np.array(robot.home, dtype=float)
    lower, upper = arm.search_bounds(home)
    w = new_workspace(arm.chain)
    for k in range(RESTARTS):
        q = rng.uniform(lower, upper) if k else np.clip(home, lower, upper)
        distance, angle, _ = refine(
            arm.chain, target, np.ascontiguousarray(q), lower, upper, Effort(60, 20), w
        )
        if distance <= position and angle <= orientation:
            return True
    return False


def _target(error: ikplan.Unreachable, request: ikplan.PlanRequest) -> Target:
    """The target that a verdict names."""
    told = error.target
    assert told is not None
    quaternion = told["quaternion_xyzw"]
    R = None if quaternion is None else rotation_of(quaternion)
    return pose_target(np.array(told["position"]), R, freedom=freedom_of(request.path))


def figures(
    count: int, seed: int = SEED, names: list[str] | None = None, kind: str = "plan"
) -> Iterator[Figure]:
    """Yield how many of random requests are refused, and what of these refusals is wrong."""
    verdicts: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    inside = disproved = unjudged = offered = broken = without = 0
    for number in range(count):
        if number and number % _TELL == 0:
            refused = number - verdicts["planned"]
            print(
                f"  {number} of {count}: {refused} refused, {disproved + inside} of these "
                f"disproved, {broken} of {offered} repairs do not plan",
                flush=True,
            )
        document: dict[str, Any] = draw(kind, seed, number, BUDGET_S, names)
        document["scene"] = {"self_collision": False}
        try:
            ikplan.plan(document)
        except (ikplan.Unreachable, ikplan.Disconnected, ikplan.TimingFailed) as error:
            refusal = error
        except ikplan.IkplanError as error:
            verdicts[type(error).__name__] += 1
            continue
        else:
            verdicts["planned"] += 1
            continue
        verdicts[type(refusal).__name__] += 1
        if not refusal.repairs:
            without += 1
            print(f"  no repair offered: request {number}: {refusal}", flush=True)
        request = ikplan.PlanRequest.model_validate(document)
        if isinstance(refusal, ikplan.Disconnected):
            followed = followed_from(request)
            unjudged += followed is None
            if followed is not None and followed[0] is not None:
                disproved += 1
                print(
                    f"  disproved: request {number}: {followed[0].tolist()}: {refusal}", flush=True
                )
        elif isinstance(refusal, ikplan.Unreachable):
            tolerance = request.path.tolerance
            off = refusal.position_error, refusal.orientation_error or 0.0
            if off[0] <= tolerance.position and off[1] <= tolerance.orientation:
                inside += 1
                print(f"  inside the tolerance: request {number}: {refusal}", flush=True)
            elif reached(
                resolve_robot(request, None),
                _target(refusal, request),
                tolerance.position,
                tolerance.orientation,
            ):
                disproved += 1
                print(f"  disproved: request {number}: {refusal}", flush=True)
        for repair in refusal.repairs:
            offered += 1
            kinds[" ".join(repair["detail"].split()[:2])] += 1
            try:
                ikplan.plan(merged_document(document, repair["change"]))
            except ikplan.IkplanError as error:
                broken += 1
                print(f"  no repair: request {number}: {repair}: {error}", flush=True)
    for verdict, number in sorted(verdicts.items()):
        yield Figure(f"{verdict}, of {count}", number, "")
    yield Figure("Unreachable, but the closest is inside the tolerance", inside, "", most=0)
    yield Figure("refusals disproved", disproved, "", most=0)
    yield Figure("Disconnected, not judged: several tool paths, or none", unjudged, "")
    yield Figure("repairs offered", offered, "")
    yield Figure("repairs that do not plan", broken, "", most=0)
    yield Figure("verdicts without a repair", without, "")
    for kind, number in sorted(kinds.items()):
        yield Figure(f"repairs: {kind} ...", number, "")
