"""URScript programs: who can have one, and that they play as planned."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

import ikplan
from benchmarks.programs.plans import random_plans
from benchmarks.programs.playing import compare
from benchmarks.programs.urscript import ScriptError, play
from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan import InvalidRequest, load_robot
from ikplan.documents.controller import ControllerInfo, LanguageInfo
from ikplan.plans.export import FORMATS, check_format, encode, format_for
from ikplan.plans.export.resampling import CLOSE_ENOUGH, positions_at_cycle
from ikplan.robots import RobotUpload

from .plans import CB3, E_SERIES, rest_to_rest

UR = {
    "cb3": (("ur3", "ur5", "ur10"), 0.008),
    "e-series": (("ur3e", "ur5e", "ur10e"), 0.002),
}


@pytest.mark.parametrize("variant", UR)
def test_random_plans_play_as_planned_at_the_controllers_cycle(variant: str) -> None:
    robots, cycle = UR[variant]
    short = (plan for plan in random_plans(robots, seed=3) if plan.duration < 19.0)
    for plan in itertools.islice(short, 4):
        found = compare(plan, load_robot(plan.robot), cycle)
        assert abs(found.duration) <= 1e-9
        assert found.off_grid <= 1e-9
        assert found.joints <= 1e-8
        assert found.tool <= 1e-7


@pytest.mark.parametrize("controller", [CB3, E_SERIES], ids=["cb3", "e-series"])
def test_a_program_of_8_8_seconds_takes_8_8_seconds(controller: ControllerInfo) -> None:
    cycle = controller.cycle
    samples = round(8.8 / cycle) + 1
    plan = rest_to_rest(6, samples, controller=controller, duration=8.8)
    played = play(encode(plan, "urscript").decode(), cycle)
    assert played.time[-1] == pytest.approx(8.8, abs=1e-12)
    assert len(played.time) == samples
    np.testing.assert_allclose(played.q, plan.q, atol=1e-9)
    assert played.stopped


def test_the_interpreter_sees_what_a_controller_would_do_otherwise() -> None:
    program = encode(rest_to_rest(6, 551, controller=E_SERIES), "urscript").decode()
    # On a controller with another cycle every step takes four times as long.
    assert play(program, 0.008).time[-1] == pytest.approx(4.4)
    # A function that is not called moves nothing.
    uncalled = program.rsplit("\n", 2)[0] + "\n"
    with pytest.raises(ScriptError, match="moves nothing"):
        play(uncalled, 0.002)
    with pytest.raises(ScriptError, match="not a number"):
        play(program.replace("0.000000000", "1e-9", 1), 0.002)


@pytest.mark.parametrize("name", REFERENCE_ROBOTS)
def test_a_program_goes_with_the_controller_and_not_with_the_name(name: str) -> None:
    info = load_robot(name).info()
    for known in FORMATS:
        path = f"plan{known.suffixes[0]}"
        others = {"urscript": "ur", "rapid": "abb", "krl": "kuka"}
        others |= {"fanuc-ls": "fanuc", "drl": "doosan"}
        arms = {"xarm": ("xarm", "lite6"), "franky": ("panda", "fer", "fr3")}
        if not name.startswith(arms.get(known.name, others.get(known.name, ""))):
            with pytest.raises(InvalidRequest, match=name) as caught:
                check_format(info, path)
            assert caught.value.field == "format"
        else:
            assert check_format(info, path) is known is format_for(path)
            assert check_format(info.model_dump(mode="json"), path) is known
    with pytest.raises(InvalidRequest, match="tell a format"):
        check_format(info, "plan.xlsx")


def test_an_uploaded_six_joint_arm_has_programs_where_its_controller_says_so(
    tmp_path: Path,
) -> None:
    urdf = load_robot("ur5e").description.urdf
    joints = [
        {"name": j.name, "lower": j.lower, "upper": j.upper, "velocity": j.velocity}
        for j in load_robot("ur5e").info().joints
    ]
    upload = {"urdf": urdf, "tip": "tool0", "joints": joints}
    controller = {
        "title": "mine",
        "cycle": 0.004,
        "languages": [{"name": "urscript", "variant": "e-series"}],
    }
    plain, able = (RobotUpload(**u) for u in (upload, {**upload, "controller": controller}))
    assert plain.content_id() != able.content_id()
    with pytest.raises(InvalidRequest, match="no controller is known"):
        check_format(plain.robot().info(), "a.script")
    robot = able.robot()
    check_format(robot.info(), "a.script")
    home = load_robot("ur5e").home
    plan = ikplan.time_path(robot, [home, home + 0.2])
    assert plan.timing is not None
    assert (plan.timing.rate_hz, plan.timing.rate_source) == (250.0, "controller")
    plan.save(tmp_path / "a.script")
    assert compare(plan, robot, 0.004).duration == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("dof", "units", "controller", "words"),
    [
        (7, None, CB3, "has 7 joints"),
        (6, ("rad",) * 5 + ("m",), CB3, "six turning joints"),
        (6, None, ControllerInfo(title="FCI", cycle=0.001), "runs none"),
        (6, None, None, "no controller is known"),
    ],
)
def test_a_program_is_refused_to_other_arms_and_nothing_is_written(
    dof: int, units: tuple[str, ...] | None, controller: ControllerInfo | None, words: str,
    tmp_path: Path,
) -> None:  # fmt: skip
    plan = rest_to_rest(dof, 11, units, controller)
    with pytest.raises(InvalidRequest, match=words) as caught:
        plan.save(tmp_path / "plan.script")
    assert caught.value.field == "format"
    assert not list(tmp_path.iterdir())


def test_a_program_longer_than_the_longest_is_refused_with_what_to_do() -> None:
    for longest, refused in ((111, False), (110, True)):
        language = LanguageInfo(name="urscript", variant="cb3", longest_program=longest)
        controller = ControllerInfo(title="small", cycle=0.01, languages=[language])
        plan = rest_to_rest(6, 111, controller=controller)
        if not refused:
            assert encode(plan, "urscript").count(b"servoj") == 110
            continue
        with pytest.raises(InvalidRequest, match=r"111 samples.*110 \(1.09 s\).*in parts"):
            encode(plan, "urscript")


@pytest.mark.parametrize(
    ("rate_hz", "form"), [(250.0, "samples"), (500.0, "samples"), (40.0, "polynomial")]
)
def test_a_plan_at_another_rate_is_played_at_the_cycle(rate_hz: float, form: str) -> None:
    robot = load_robot("ur5")
    q = robot.home + np.cumsum(np.full((4, 6), 0.1), axis=0) * [1, -1, 1, 1, 0.5, 2]
    request = {"robot": "ur5", "waypoints": [robot.home.tolist(), *q.tolist()]}
    plan = ikplan.time_request({**request, "sampling": {"rate_hz": rate_hz, "form": form}})
    played = play(encode(plan, "urscript").decode(), 0.008)
    known = plan.at(np.minimum(played.time, plan.duration))[0]
    assert np.abs(np.array(played.q) - known).max() <= 1e-9
    # The rest of the cycle in which the motion ends is spent at its end.
    assert 0.0 <= played.time[-1] - plan.duration < 0.008
    assert np.abs(played.q[-1] - plan.q[-1]).max() <= 1e-9


def test_samples_too_far_apart_are_refused_and_others_are_as_close_as_said() -> None:
    robot = load_robot("ur5")
    waypoints = [robot.home.tolist(), (robot.home + 0.5).tolist(), robot.home.tolist()]
    request = {"robot": "ur5", "waypoints": waypoints}
    exact = ikplan.time_request({**request, "sampling": {"rate_hz": 20.0, "form": "polynomial"}})
    coarse = ikplan.time_request({**request, "sampling": {"rate_hz": 20.0}})
    with pytest.raises(InvalidRequest, match="too far apart") as caught:
        encode(coarse, "urscript")
    assert caught.value.field == "sampling.rate_hz"
    off = np.abs(coarse.at(exact_times := np.arange(0.0, exact.duration, 0.003))[0]
                 - exact.at(exact_times)[0]).max()  # fmt: skip
    assert off > CLOSE_ENOUGH
    fine = ikplan.time_request({**request, "sampling": {"rate_hz": 700.0}})
    known = ikplan.time_request({**request, "sampling": {"rate_hz": 700.0, "form": "polynomial"}})
    times = np.minimum(np.arange(len(q := positions_at_cycle(fine, 0.008))) * 0.008, fine.duration)
    assert np.abs(q - known.at(times)[0]).max() <= CLOSE_ENOUGH


def test_a_plan_that_stands_still_is_a_program_that_stands_still() -> None:
    robot = load_robot("ur5")
    plan = ikplan.time_path(robot, [robot.home])
    played = play(encode(plan, "urscript").decode(), 0.008)
    assert played.time == []
    assert played.approach is not None
    np.testing.assert_allclose(played.approach, robot.home, atol=1e-9)
