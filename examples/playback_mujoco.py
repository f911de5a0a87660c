"""Plays plans on simulated servos: ``python examples/playback_mujoco.py``; needs ``mujoco``.

The model is made from the robot's own description: axes, placements, and inertias where its source
gives them. Where it gives none, the links are rods whose masses add up to the maker's mass of the
arm: torques are then a guess. Gravity is compensated, as in every arm.

A position servo has the torque ``kp (q_wanted - q) - kv dq``. Fed with the plan's positions alone,
it lags by ``kv / kp`` seconds; fed with ``q + (kv / kp) dq`` (lead) it does not.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import ikplan

Array = NDArray[np.float64]

STEP = 0.0005
"""Time step of the simulation [s]."""
GAINS = ((200.0, 4500.0), (100.0, 3500.0), (0.0, 2000.0))
"""Smallest torque limit [N m], and the gain kp of a joint that has at least that [N m/rad]."""
DAMPING = 0.1
"""kv / kp [s]."""
ARMATURE = 0.1
"""Inertia of motor and gear, at the joint [kg m^2]."""
MASSES = {"ur5e": 20.6, "iiwa14": 29.9}
"""The arm's mass by the maker's data sheet, for descriptions without inertias [kg]."""
_RADIUS = 0.05
"""Radius of the rods that stand for links without an inertia [m]."""


@dataclass(frozen=True)
class Tracking:
    """How far the simulated arm is from the plan, at the plan's sample times.

    Attributes:
        joint: Largest joint error [rad].
        in_time: Largest distance of the tool from where it should be at that time [m].
        off_path: Largest distance of the tool from the path [m].
        saturated: Share of steps in which a motor is at its torque limit.
    """

    joint: float
    in_time: float
    off_path: float
    saturated: float


def _inertias(robot: ikplan.Robot) -> list[tuple[float, Array, Array]]:
    """Mass, centre of mass and inertia about it of each moving link, in its joint's frame."""
    model = robot.model
    given = [model.inertias[j] for j in range(1, model.njoints)]
    if all(inertia.mass > 0.0 for inertia in given):
        return [(i.mass, np.array(i.lever), np.array(i.inertia)) for i in given]
    ends = [model.jointPlacements[j].translation for j in range(2, model.njoints)]
    tool = robot.fk(np.zeros(robot.dof))
    placed = model.createData()
    import pinocchio as pin

    pin.forwardKinematics(model, placed, np.zeros(model.nq))
    ends = [*ends, placed.oMi[model.njoints - 1].actInv(tool).translation]
    lengths = np.array([max(float(np.linalg.norm(end)), 2.0 * _RADIUS) for end in ends])
    masses = MASSES.get(robot.name, 20.0) * lengths / lengths.sum()
    found = []
    for end, length, mass in zip(ends, lengths, masses, strict=True):
        axis = end / max(float(np.linalg.norm(end)), 1e-9)
        across = mass * (length**2 / 12.0 + _RADIUS**2 / 4.0)
        along = mass * _RADIUS**2 / 2.0
        inertia = across * np.eye(3) + (along - across) * np.outer(axis, axis)
        found.append((float(mass), 0.5 * np.array(end), inertia))
    return found


def mujoco_model(robot: ikplan.Robot) -> mujoco.MjModel:
    """Return a MuJoCo model of an arm of turning joints, a position servo at each."""
    spec = mujoco.MjSpec()
    spec.option.timestep = STEP
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    body, model = spec.worldbody, robot.model
    for j, (mass, centre, inertia) in enumerate(_inertias(robot), start=1):
        placement = model.jointPlacements[j]
        body = body.add_body(name=model.names[j], pos=placement.translation, gravcomp=1.0)
        quaternion = np.empty(4)
        mujoco.mju_mat2Quat(quaternion, placement.rotation.ravel())
        body.quat = quaternion
        body.explicitinertial = True
        body.mass, body.ipos = mass, centre
        xx, yy, zz, xy, xz, yz = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
        body.fullinertia = [xx, yy, zz, xy, xz, yz]
        axis = "XYZ".index(model.joints[j].shortname()[-1])
        body.add_joint(
            name=model.names[j],
            type=mujoco.mjtJoint.mjJNT_HINGE,
            axis=np.eye(3)[axis],
            armature=ARMATURE,
        )
        torque = float(model.effortLimit[j - 1])
        kp = next(gain for least, gain in GAINS if torque >= least)
        servo = spec.add_actuator(name=model.names[j], target=model.names[j])
        servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
        servo.set_to_position(kp=kp, kv=DAMPING * kp)
        servo.forcelimited, servo.forcerange = True, [-torque, torque]
    return spec.compile()


def play(plan: ikplan.Plan, robot: ikplan.Robot, *, lead: bool) -> Tracking:
    """Feed a plan to the servos at its own sample times, each held until the next."""
    model = mujoco_model(robot)
    data = mujoco.MjData(model)
    data.qpos[:] = plan.q[0]
    limits = model.actuator_forcerange[:, 1]
    reached, at_limit, steps = [plan.q[0]], 0, 0
    for k in range(len(plan.time) - 1):
        data.ctrl[:] = plan.q[k] + (DAMPING * plan.dq[k] if lead else 0.0)
        while data.time < plan.time[k + 1] - 0.5 * STEP:
            mujoco.mj_step(model, data)
            at_limit += bool((np.abs(data.actuator_force) >= limits - 1e-9).any())
            steps += 1
        reached.append(data.qpos.copy())
    q = np.array(reached)
    _, wanted = robot.poses(plan.q)
    _, found = robot.poses(q)
    near = [float(np.linalg.norm(wanted - p, axis=1).min()) for p in found]
    return Tracking(
        float(np.abs(q - plan.q).max()),
        float(np.linalg.norm(found - wanted, axis=1).max()),
        max(near),
        at_limit / max(steps, 1),
    )


def requests() -> dict[str, dict[str, Any]]:
    """The plans that are played, by name."""
    examples = Path(__file__).parent
    helix = json.loads((examples / "helix_iiwa14.json").read_text())
    lines = json.loads((examples / "lines_panda.json").read_text())
    down = {"quaternion_xyzw": [1.0, 0.0, 0.0, 0.0]}
    first, *corners = [[0.45, -0.2, 0.3], [0.45, 0.2, 0.3], [0.6, 0.2, 0.5], [0.45, -0.2, 0.3]]
    ur = {
        "robot": "ur5e",
        "start": "free",
        "path": {
            "begin": {"position": first, **down},
            "segments": [
                {"type": "line", "to": {"position": corners[0], **down}, "blend": 0.03},
                {"type": "line", "to": {"position": corners[1], **down}, "blend": 0.03},
                {"type": "line", "to": {"position": corners[2], **down}},
            ],
        },
        "limits": {"tool_speed": {"linear": 0.25}},
    }
    return {"panda, lines": lines, "ur5e, lines": ur, "iiwa14, helix": helix}


def main() -> int:
    """Print how well the servos follow."""
    print(
        f"{'plan':16} {'servo':10} {'joints':>10} {'in time':>10} {'off path':>10} {'at limit':>9}"
    )
    for name, request in requests().items():
        plan, robot = ikplan.plan(request), ikplan.load_robot(request["robot"])
        for lead in (False, True):
            found = play(plan, robot, lead=lead)
            servo = "with lead" if lead else "positions"
            print(
                f"{name:16} {servo:10} {1e3 * found.joint:5.1f} mrad "
                f"{1e3 * found.in_time:7.2f} mm {1e3 * found.off_path:7.2f} mm "
                f"{100 * found.saturated:7.1f} %"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
