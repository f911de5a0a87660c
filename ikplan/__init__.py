"""ikplan: a tool path in, a certified joint trajectory out.

The public names are imported on first use, so that a client needs neither Pinocchio nor a compiler.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ikplan._lazy import on_first_use
from ikplan._version import __version__

if TYPE_CHECKING:
    from ikplan.arena.compare import compare
    from ikplan.arena.comparison import Comparison
    from ikplan.arena.objective import objective
    from ikplan.client import AsyncClient, AsyncPlanJob, Client, PlanJob
    from ikplan.documents.certificate import Certificate
    from ikplan.documents.plan_request import PlanRequest
    from ikplan.documents.pose_results import FkResult, IkBatchSolution, IkSolution
    from ikplan.documents.requests.fk import FkRequest
    from ikplan.documents.requests.ik import IkRequest
    from ikplan.documents.status import PlanStatus
    from ikplan.documents.timing_request import TimingRequest
    from ikplan.errors import (
        AccessDenied,
        BudgetExceeded,
        CertificateViolated,
        Disconnected,
        IkplanError,
        InCollision,
        InvalidInput,
        InvalidRequest,
        InvalidRobot,
        MemoryExceeded,
        NoPlan,
        PlanNotFound,
        RateLimited,
        RobotNotFound,
        ServiceError,
        ServiceUnavailable,
        TimingFailed,
        Unreachable,
        WorkerLost,
    )
    from ikplan.gcode import read_gcode
    from ikplan.ik.registry import register_solver
    from ikplan.pipeline.asked.together import PlansTogether, plan_together
    from ikplan.pipeline.move import move
    from ikplan.pipeline.plan import plan
    from ikplan.pipeline.pose_batch.solve import solve_ik_batch
    from ikplan.pipeline.poses import solve_ik
    from ikplan.pipeline.retime import time_path, time_request
    from ikplan.placement.place import Placement, place
    from ikplan.plans.plan import Plan
    from ikplan.points import read_waypoints
    from ikplan.reach.reach_map import ReachMap, reach_map
    from ikplan.robots import Robot, load_robot, robot_names
    from ikplan.scene.read_scene import read_scene
else:
    __getattr__ = on_first_use(
        __name__,
        {
            "AccessDenied": "errors",
            "AsyncClient": "client",
            "AsyncPlanJob": "client",
            "BudgetExceeded": "errors",
            "Certificate": "documents.certificate",
            "CertificateViolated": "errors",
            "Client": "client",
            "Comparison": "arena.comparison",
            "Disconnected": "errors",
            "FkRequest": "documents.requests.fk",
            "FkResult": "documents.pose_results",
            "IkBatchSolution": "documents.pose_results",
            "IkRequest": "documents.requests.ik",
            "IkSolution": "documents.pose_results",
            "IkplanError": "errors",
            "InvalidInput": "errors",
            "InCollision": "errors",
            "InvalidRequest": "errors",
            "InvalidRobot": "errors",
            "MemoryExceeded": "errors",
            "NoPlan": "errors",
            "Plan": "plans.plan",
            "Placement": "placement.place",
            "PlanJob": "client",
            "PlanNotFound": "errors",
            "PlanRequest": "documents.plan_request",
            "PlanStatus": "documents.status",
            "PlansTogether": "pipeline.asked.together",
            "RateLimited": "errors",
            "ReachMap": "reach.reach_map",
            "Robot": "robots",
            "RobotNotFound": "errors",
            "ServiceError": "errors",
            "ServiceUnavailable": "errors",
            "TimingFailed": "errors",
            "TimingRequest": "documents.timing_request",
            "Unreachable": "errors",
            "WorkerLost": "errors",
            "compare": "arena.compare",
            "load_robot": "robots",
            "objective": "arena.objective",
            "register_solver": "ik.registry",
            "move": "pipeline.move",
            "plan": "pipeline.plan",
            "place": "placement.place",
            "plan_together": "pipeline.asked.together",
            "reach_map": "reach.reach_map",
            "read_scene": "scene.read_scene",
            "read_gcode": "gcode",
            "read_waypoints": "points",
            "robot_names": "robots",
            "solve_ik": "pipeline.poses",
            "solve_ik_batch": "pipeline.pose_batch.solve",
            "time_path": "pipeline.retime",
            "time_request": "pipeline.retime",
        },
    )

__all__ = [
    "AccessDenied",
    "AsyncClient",
    "AsyncPlanJob",
    "BudgetExceeded",
    "Certificate",
    "CertificateViolated",
    "Client",
    "Comparison",
    "Disconnected",
    "FkRequest",
    "FkResult",
    "IkBatchSolution",
    "IkRequest",
    "IkSolution",
    "IkplanError",
    "InCollision",
    "InvalidInput",
    "InvalidRequest",
    "InvalidRobot",
    "MemoryExceeded",
    "NoPlan",
    "Placement",
    "Plan",
    "PlanJob",
    "PlanNotFound",
    "PlanRequest",
    "PlanStatus",
    "PlansTogether",
    "RateLimited",
    "ReachMap",
    "Robot",
    "RobotNotFound",
    "ServiceError",
    "ServiceUnavailable",
    "TimingFailed",
    "TimingRequest",
    "Unreachable",
    "WorkerLost",
    "__version__",
    "compare",
    "load_robot",
    "move",
    "objective",
    "place",
    "plan",
    "plan_together",
    "reach_map",
    "read_gcode",
    "read_scene",
    "read_waypoints",
    "register_solver",
    "robot_names",
    "solve_ik",
    "solve_ik_batch",
    "time_path",
    "time_request",
]


def __dir__() -> list[str]:
    return __all__
