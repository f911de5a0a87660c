"""From a description to a Pinocchio model of the chain alone."""

from __future__ import annotations

import functools

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan.errors import InvalidRobot
from ikplan.robots.description import RobotDescription

__all__ = ["build_model", "coupling_arrays", "frame_id"]


@functools.lru_cache(maxsize=64)
def _parsed(name: str, urdf: str) -> pin.Model:
    """The model of a checked URDF; never handed out, only copied."""
    try:
        return pin.buildModelFromXML(urdf)
    except (ValueError, RuntimeError) as error:
        raise InvalidRobot(f"{name}: Pinocchio refuses the model: {error}", robot=name) from error


def build_model(description: RobotDescription) -> pin.Model:
    """Build the model of the chain, with the description's limits.

    Args:
        description: The robot.

    Returns:
        A model with one joint per serial joint. Continuous joints take two configuration entries,
        (cos, sin). Position limits of coupled serial joints are the range their users' joints
        allow.

    Raises:
        InvalidRobot: Pinocchio refuses the description.
    """
    model = pin.Model(_parsed(description.name, description.urdf))
    matrix, offset = coupling_arrays(description)
    joints = description.joints
    lower = np.array([j.lower for j in joints])
    upper = np.array([j.upper for j in joints])
    with np.errstate(invalid="ignore"):
        # 0 * inf is nan; such an entry plays no part in the range.
        low = np.nansum(np.where(matrix > 0, matrix * lower, matrix * upper), axis=1) + offset
        high = np.nansum(np.where(matrix > 0, matrix * upper, matrix * lower), axis=1) + offset
    for i, joint in enumerate(model.joints[1:]):
        if joint.nq == 1:
            model.lowerPositionLimit[joint.idx_q] = low[i]
            model.upperPositionLimit[joint.idx_q] = high[i]
    velocity = np.abs(matrix) @ np.array([j.velocity for j in joints])
    model.upperVelocityLimit[:] = velocity
    model.lowerVelocityLimit[:] = -velocity
    if description.coupling is None:
        effort = np.array([j.effort for j in joints])
        model.upperEffortLimit[:] = np.where(np.isnan(effort), np.inf, effort)
    else:
        model.upperEffortLimit[:] = np.inf
    model.lowerEffortLimit[:] = -model.upperEffortLimit
    return model


def coupling_arrays(
    description: RobotDescription,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Coupling matrix (n_serial, dof) and offset (n_serial,); identity and zero without one."""
    coupling = description.coupling
    if coupling is None:
        n = len(description.joints)
        return np.eye(n), np.zeros(n)
    return np.array(coupling.matrix, dtype=np.float64), np.array(coupling.offset, dtype=np.float64)


def frame_id(model: pin.Model, link: str) -> int:
    """Id of a link's frame. A joint may have the same name, so only bodies are looked at."""
    return int(model.getFrameId(link, pin.FrameType.BODY))
