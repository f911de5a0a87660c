"""How near bodies are at samples of a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.clearance.windows import is_there, windows_of
from ikplan.scene.contacts import Contacts
from ikplan.scene.poses import carrier_poses

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot
    from ikplan.scene.body import CollisionModel

__all__ = ["clearance_over_time"]

_SAMPLES = 160
"""Most samples at which distances are measured."""


def clearance_over_time(
    plan: PlanDocument, robot: Robot, model: CollisionModel
) -> tuple[Array, Array]:
    """Return the least distance of a model's pairs at samples of a plan.

    Args:
        plan: The plan.
        robot: The robot, with its tool.
        model: The bodies and pairs.

    Returns:
        Times [s] and distances, 0 where bodies overlap [m], each of shape (m,); without a pair at
        a time the distance is NaN.
    """
    time, q = plan.trajectory.time, plan.trajectory.q
    chosen = np.unique(np.linspace(0, len(time) - 1, min(len(time), _SAMPLES)).round().astype(int))
    clearance = plan.certificate.clearance
    segments = clearance.segments if clearance is not None else []
    windows = windows_of(float(time[-1]), [(s.begin, s.end) for s in segments] or None)
    contacts: dict[bytes, Contacts] = {}
    distances = []
    for t, values in zip(time[chosen], q[chosen], strict=True):
        now = [w for w in windows if w.begin <= t <= w.end] or windows[-1:]
        there = np.array([any(is_there(b, w) for w in now) for b in model.bodies], dtype=np.bool_)
        pairs = model.pairs[there[model.pairs].all(axis=1)]
        key = there.tobytes()
        if key not in contacts:
            contacts[key] = Contacts(model.bodies, pairs)
        nearest = contacts[key].nearest(*carrier_poses(robot, values))
        distances.append(np.nan if nearest is None else max(nearest.distance, 0.0))
    return time[chosen], np.array(distances)
