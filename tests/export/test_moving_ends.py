"""Programs that a controller begins by itself hold motions from rest to rest only."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import ikplan
from ikplan.plans.export import FORMATS, encode

PROGRAMS = [
    ("ur5", "urscript"),
    ("abb_irb2400_12_155", "rapid"),
    ("kuka_kr6_r900_sixx", "krl"),
    ("fanuc_lrmate200id", "fanuc-ls"),
    ("doosan_m1013", "drl"),
    ("xarm7", "xarm"),
    ("panda", "franky"),
]
ENDS = ["start_velocity", "end_velocity"]


def moving(name: str, **ends: Any) -> ikplan.Plan:
    robot = ikplan.load_robot(name)
    return ikplan.time_path(robot, robot.home + 0.1 * np.arange(3)[:, None], **ends)


def test_the_programs_are_those_of_makers_controllers() -> None:
    assert {f.name for f in FORMATS if f.from_rest} == {name for _, name in PROGRAMS}


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize(("name", "program"), PROGRAMS)
def test_a_plan_with_a_moving_end_is_no_program(name: str, program: str, end: str) -> None:
    dof = ikplan.load_robot(name).dof
    plan = moving(name, **{end: [0.1] * dof})
    with pytest.raises(ikplan.InvalidRequest) as refused:
        encode(plan, program)
    assert refused.value.field == "format"
    assert "in motion" in str(refused.value)
    assert refused.value.allowed == ["json", "csv", "npz", "ros", "ros-goal"]


def test_an_arm_without_that_controller_is_refused_first() -> None:
    with pytest.raises(ikplan.InvalidRequest, match="its controller runs none"):
        encode(moving("ur5", start_velocity=[0.1] * 6), "rapid")


@pytest.mark.parametrize("known", [f.name for f in FORMATS if not f.from_rest])
def test_samples_are_written_as_they_move(known: str) -> None:
    assert encode(moving("ur5", start_velocity=[0.1] * 6), known)


@pytest.mark.parametrize(("name", "program"), PROGRAMS)
def test_a_plan_from_rest_to_rest_is_a_program(name: str, program: str) -> None:
    assert encode(moving(name), program)
