"""Plans on simulated servos."""

from __future__ import annotations

import importlib.util
from pathlib import Path
from types import ModuleType

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import Plan
from tests.export.plans import rest_to_rest

pytest.importorskip("mujoco")


@pytest.fixture(scope="module")
def playback() -> ModuleType:
    file = Path(__file__).parents[2] / "examples" / "playback_mujoco.py"
    spec = importlib.util.spec_from_file_location("playback_mujoco", file)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


@pytest.mark.parametrize("name", ["panda", "ur5e", "iiwa14"])
def test_model_is_the_robot(playback: ModuleType, name: str) -> None:
    import mujoco

    robot = ikplan.load_robot(name)
    model = playback.mujoco_model(robot)
    data = mujoco.MjData(model)
    q = robot.random_configuration(np.random.default_rng(1))
    data.qpos[:] = q
    mujoco.mj_forward(model, data)
    placed = robot.model.createData()
    pin.forwardKinematics(robot.model, placed, q)
    last = placed.oMi[robot.model.njoints - 1]
    np.testing.assert_allclose(data.xpos[-1], last.translation, atol=1e-6)
    np.testing.assert_allclose(data.xmat[-1].reshape(3, 3), last.rotation, atol=1e-6)
    if name == "panda":
        mujoco_mass = np.empty((7, 7))
        mujoco.mj_fullM(model, data, mujoco_mass)
        wanted = pin.crba(robot.model, placed, q)
        wanted = np.triu(wanted) + np.triu(wanted, 1).T
        mujoco_mass -= playback.ARMATURE * np.eye(7)
        np.testing.assert_allclose(mujoco_mass, wanted, atol=1e-3)


def test_lead_takes_the_lag_away(playback: ModuleType) -> None:
    robot = ikplan.load_robot("ur5e")
    plan: Plan = rest_to_rest(6, 200, ("rad",) * 6).model_copy(
        update={"robot": "ur5e", "joint_names": list(robot.joint_names)}
    )
    plain = playback.play(plan, robot, lead=False)
    lead = playback.play(plan, robot, lead=True)
    # A position servo lags by kv / kp.
    assert plain.joint == pytest.approx(playback.DAMPING * np.abs(plan.dq).max(), rel=0.2)
    assert lead.joint < 0.2 * plain.joint
    assert lead.in_time < plain.in_time
