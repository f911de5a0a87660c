"""Two arms of one description as one robot with one timing."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ikplan


def joint(name: str, parent: str, child: str, xyz: str, axis: str) -> str:
    return (
        f'<joint name="{name}" type="revolute"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>'
        '<limit lower="-2.9" upper="2.9" velocity="2" effort="100"/></joint>'
    )


def link(name: str, length: float = 0.0) -> str:
    shape = (
        f'<collision><origin xyz="0 0 {length / 2}"/><geometry><cylinder radius="0.04" '
        f'length="{length}"/></geometry></collision>'
        if length
        else ""
    )
    return f'<link name="{name}">{shape}</link>'


def arm(side: str, y: float) -> str:
    return (
        link(f"{side}_1")
        + link(f"{side}_2", 0.35)
        + link(f"{side}_3", 0.3)
        + joint(f"{side}_turn", "torso", f"{side}_1", f"0 {y} 0.4", "0 0 1")
        + joint(f"{side}_lift", f"{side}_1", f"{side}_2", "0 0 0.05", "0 1 0")
        + joint(f"{side}_bend", f"{side}_2", f"{side}_3", "0 0 0.4", "0 1 0")
    )


CELLS: list[Path] = []


@pytest.fixture(scope="module")
def both(tmp_path_factory: pytest.TempPathFactory) -> ikplan.Robot:
    path: Path = tmp_path_factory.mktemp("two") / "two.urdf"
    path.write_text(
        f'<robot name="two">{link("torso")}{arm("left", 0.3)}{arm("right", -0.3)}</robot>'
    )
    CELLS.append(path)
    return ikplan.load_robot(path, base="left_3", tip="right_3")


APART = np.array([[0.5, 0.9, 0.3, -0.3, 0.9, 0.5], [0.9, 0.6, 0.4, -0.5, 0.4, 0.9]])
"""Joints from the left tool up to the torso and down to the right tool."""


def test_both_arms_pass_their_waypoints_together_under_the_limits_of_both(
    both: ikplan.Robot,
) -> None:
    assert both.joint_names == (
        "left_bend", "left_lift", "left_turn", "right_turn", "right_lift", "right_bend",
    )  # fmt: skip
    plan = ikplan.time_path(both, APART)
    assert (np.abs(plan.dq) <= both.velocity_limit * (1 + 1e-9)).all()
    assert np.abs(plan.q[-1] - APART[-1]).max() == 0.0
    halves = [ikplan.time_path(both, np.vstack([APART[0], row])) for row in (
        np.concatenate([APART[1, :3], APART[0, 3:]]), np.concatenate([APART[0, :3], APART[1, 3:]])
    )]  # fmt: skip
    assert plan.duration == pytest.approx(max(half.duration for half in halves), rel=0.2)


def test_the_arms_are_proven_to_keep_apart_or_refused(both: ikplan.Robot) -> None:
    request = {"robot": "two", "waypoints": APART.tolist(), "scene": {}}
    free = ikplan.time_request(request, robot=both)
    assert free.certificate.clearance is not None
    assert free.certificate.clearance.proven
    crossing = APART.copy()
    crossing[1] = [0.3, 1.4, -1.0, 1.0, 1.4, 0.3]
    with pytest.raises(ikplan.InCollision) as refused:
        ikplan.time_request({**request, "waypoints": crossing.tolist()}, robot=both)
    assert {name.partition("_")[0] for name in refused.value.pair} == {"left", "right"}


def test_two_tool_paths_run_together(both: ikplan.Robot) -> None:
    arms: dict[str, tuple[ikplan.Robot, dict[str, Any]]] = {}
    for side in ("left", "right"):
        robot = ikplan.load_robot(CELLS[0], base="torso", tip=f"{side}_3")
        start = np.array([0.3, 0.9, 0.5]) * ([1, 1, 1] if side == "left" else [-1, 1, 1])
        x, y, z = robot.with_tool([0.0, 0.0, 0.3]).fk(start).translation.tolist()
        far = 0.1 if side == "left" else 0.05
        segments: list[dict[str, Any]] = [
            {"type": "line", "to": {"position": [x - far, y, z]}},
            {"type": "line", "to": {"position": [x - far, y, z + far]}},
        ]
        path = {"segments": segments, "orientation_free": "all"}
        request: dict[str, Any] = {"robot": side, "start": start.tolist(), "path": path}
        request["tool"] = {"position": [0.0, 0.0, 0.3]}
        request["limits"] = {"tool_speed": 0.2} if side == "left" else {}
        arms[side] = (robot, request)
    found = ikplan.plan_together(both, arms)
    left, right = found.arms["left"], found.arms["right"]
    assert found.cell.certificate.clearance is not None
    assert found.cell.certificate.clearance.proven
    assert left.certificate.valid
    assert right.certificate.valid
    assert np.array_equal(left.waypoints.time, right.waypoints.time)
    assert np.array_equal(left.time, found.cell.time)
    for side, plan in found.arms.items():
        robot, request = arms[side]
        for row, segment in enumerate(request["path"]["segments"]):
            q = plan.waypoints.q[row]
            reached = robot.with_tool([0.0, 0.0, 0.3]).fk(q).translation
            # The corner is rounded within the tolerance.
            assert np.linalg.norm(reached - segment["to"]["position"]) <= 1e-4
        assert plan.certificate.max_path_deviation is not None
        assert plan.certificate.max_path_deviation <= 1e-4
    assert (left.certificate.tool_speed_ratio or 0.0) <= 1.0 + 1e-9
