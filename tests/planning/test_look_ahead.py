"""The branch and the free orientation of a joint target are chosen with what follows."""

from __future__ import annotations

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import load_robot


@pytest.mark.parametrize("name", ["ur5", "iiwa14", "panda"])
@pytest.mark.parametrize("seed", range(3))
def test_a_position_alone_is_turned_as_the_arc_behind_it_begins(name: str, seed: int) -> None:
    robot, rng = load_robot(name), np.random.default_rng(seed)
    home = np.array(robot.home)
    T = robot.fk(np.clip(home + rng.uniform(-0.4, 0.4, robot.dof), robot.lower, robot.upper))
    along = rng.normal(size=3)
    along *= 0.06 / np.linalg.norm(along)
    aside = np.cross(along, rng.normal(size=3))
    aside *= 0.03 / np.linalg.norm(aside)
    R = T.rotation @ pin.exp3(rng.uniform(-0.5, 0.5, 3))
    to = {
        "position": (T.translation + along).tolist(),
        "quaternion_xyzw": pin.Quaternion(R).coeffs().tolist(),
    }
    segments = [
        {"type": "joint", "to": {"position": T.translation.tolist()}},
        {"type": "arc", "via": (T.translation + 0.5 * along + aside).tolist(), "to": to},
    ]
    plan = ikplan.plan(
        {
            "robot": name,
            "start": home.tolist(),
            "path": {"segments": segments},
            "scene": {"self_collision": False},
            "limits": {"jerk": False},
        }
    )
    begin, end = (robot.fk(q) for q in plan.waypoints.q)
    np.testing.assert_allclose(begin.translation, T.translation, atol=1e-8)
    np.testing.assert_allclose(end.translation, T.translation + along, atol=1e-8)
    # No orientation comes before that at the end: the tool is turned as there all the way.
    assert np.linalg.norm(pin.log3(end.rotation.T @ R)) < 1e-7
    assert np.linalg.norm(pin.log3(begin.rotation.T @ R)) < 1e-7
