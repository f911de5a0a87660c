"""A robot's forward kinematics against those of Pinocchio on the whole description."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pinocchio as pin

from ikplan.errors import InvalidRobot
from ikplan.robots.robot import Robot

__all__ = ["check_against_whole"]

_POSTURES = 50
_TOLERANCE = 1e-9


def check_against_whole(robot: Robot, urdf: bytes) -> str:
    """Compare a robot with Pinocchio's reading of the whole URDF at 50 random postures.

    Args:
        robot: The robot.
        urdf: The URDF that it was made from, expanded.

    Returns:
        What was found, in words.

    Raises:
        InvalidRobot: They differ by more than 1e-9 m or rad.
    """
    try:
        with _quiet():
            model = pin.buildModelFromXML(urdf.decode())
    except (ValueError, RuntimeError, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())
        return f"not checked against the whole file, which Pinocchio refuses: {reason}"
    frames = [model.getFrameId(name, pin.FrameType.BODY) for name in _ends(robot)]
    if max(frames) >= model.nframes:
        return "not checked against the whole file: Pinocchio knows no such frames"
    data, rng, worst = model.createData(), np.random.default_rng(50), 0.0
    names = _serial_names(robot)
    for _ in range(_POSTURES):
        q = robot.random_configuration(rng)
        serial = robot.coupling @ q + robot.coupling_offset
        configuration = pin.neutral(model)
        for name, value in zip(names, serial, strict=True):
            joint = model.joints[model.getJointId(name)]
            if joint.nq == 1:
                configuration[joint.idx_q] = value
            else:
                configuration[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        pin.framesForwardKinematics(model, data, configuration)
        T_base_tip = data.oMf[frames[0]].inverse() * data.oMf[frames[1]]
        off = (T_base_tip * robot.T_tip_tool).inverse() * robot.fk(q)
        worst = max(worst, float(np.abs(pin.log6(off).vector).max()))
    if worst > _TOLERANCE:
        raise InvalidRobot(
            f"{robot.name}: forward kinematics differ from those of the whole file by {worst:.2g} "
            "(m or rad): a fault of ikplan",
            robot=robot.name,
            value=worst,
        )
    return f"forward kinematics equal Pinocchio's on the whole file to {worst:.1e} (m or rad)"


def _ends(robot: Robot) -> tuple[str, str]:
    return robot.base_frame, robot.tip_frame


def _serial_names(robot: Robot) -> list[str]:
    coupling = robot.description.coupling
    return list(robot.joint_names if coupling is None else coupling.serial)


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep what readers of URDFs print off standard error."""
    kept, nothing = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    try:
        os.dup2(nothing, 2)
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nothing)
