"""Hand-made plans, so that files and figures are tested without planning."""

import numpy as np

from ikplan.documents.certificate import Certificate, LimitPlace
from ikplan.documents.controller import ControllerInfo, LanguageInfo
from ikplan.documents.trajectory import Stats, Trajectory, WaypointResults
from ikplan.plans.plan import Plan

CB3 = ControllerInfo(
    title="CB3", cycle=0.008, languages=[LanguageInfo(name="urscript", variant="cb3")]
)
E_SERIES = ControllerInfo(
    title="e-Series", cycle=0.002, languages=[LanguageInfo(name="urscript", variant="e-series")]
)


def rest_to_rest(
    dof: int = 2,
    samples: int = 5,
    units: tuple[str, ...] | None = None,
    controller: ControllerInfo | None = None,
    duration: float = 1.1,
) -> Plan:
    """A plan whose joints move by a cosine from rest to rest, each a little further."""
    time = np.linspace(0.0, duration, samples)
    w = np.pi / duration
    size = 0.1 * np.arange(1, dof + 1)
    q = (1 - np.cos(w * time))[:, None] * size
    dq = (w * np.sin(w * time))[:, None] * size
    ddq = (w**2 * np.cos(w * time))[:, None] * size
    place = LimitPlace(joint="j1", time=0.5)
    certificate = Certificate(
        valid=True,
        max_position_error=1e-9,
        max_orientation_error=None,
        max_path_deviation=None,
        max_orientation_deviation=None,
        position_limit_ratio=0.5,
        position_limit_at=place,
        velocity_limit_ratio=1.0,
        velocity_limit_at=place,
        acceleration_limit_ratio=0.9,
        acceleration_limit_at=place,
        min_singular_value=0.1,
        min_singular_value_time=0.3,
        elongation_sum=0.4,
        elongation_lower_bound=0.39,
    )
    return Plan(
        id="0" * 32,
        version="0.0.0",
        robot="a robot of nobody",
        joint_names=[f"j{i}, the {i}th" for i in range(1, dof + 1)],
        joint_units=list(units or ("rad",) * dof),
        waypoints=WaypointResults(
            q=q[[2, -1]],
            time=time[[2, -1]],
            position_error=[1e-9, 2e-9],
            orientation_error=[None, 1e-8],
            elongation=[0.2, 0.2],
        ),
        trajectory=Trajectory(time=time, q=q, dq=dq, ddq=ddq),
        certificate=certificate,
        controller=controller,
        stats=Stats(ik_evaluations=7, seconds={"ik": 0.01}),
    )
