"""Programs of points: who can have one, and that they play within their certificates."""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from benchmarks.programs import drl, fanuc, franky, krl, rapid, xarm
from benchmarks.programs.plans import short_timings
from benchmarks.programs.points import judge
from benchmarks.programs.urscript import ScriptError
from ikplan import InvalidRequest, load_robot
from ikplan.documents.controller import VARIANTS, LanguageInfo, ProgramLanguage
from ikplan.plans.export import check_format, encode, save
from ikplan.plans.plan import Plan
from ikplan.plans.programs.certifying import limits_of

ROBOTS = {
    "rapid": ("abb_irb2400_12_155", "abb_irb6640_185_280"),
    "krl": ("kuka_kr10_r1100_2", "kuka_kr6_r900_sixx"),
    "fanuc-ls": ("fanuc_m10ia", "fanuc_crx10ia"),
    "drl": ("doosan_m1013", "doosan_a0509"),
    "xarm": ("xarm7", "lite6"),
    "franky": ("panda", "fr3"),
}
SUFFIX = {
    "rapid": ".mod", "krl": ".src", "fanuc-ls": ".ls", "drl": ".drl", "xarm": ".xarm.py",
    "franky": ".franky.py",
}  # fmt: skip
NAMED = ("rapid", "krl", "fanuc-ls")


def still(_a: object, _b: object) -> float:
    """A tool that does not move: no zone is too small."""
    return 0.0


def moved(name: str, **changes: object) -> Plan:
    robot = load_robot(name)
    q = [
        robot.home.tolist(),
        (robot.home + 0.3).tolist(),
        (robot.home + np.array([0.4, *[0.1] * (robot.dof - 1)])).tolist(),
    ]
    return ikplan.time_request({"robot": name, "waypoints": q, **changes})


@pytest.mark.parametrize("language", ROBOTS)
def test_random_plans_play_within_the_bounds_that_are_certified(language: str) -> None:
    for plan in itertools.islice(short_timings(ROBOTS[language], seed=5), 5):
        robot = load_robot(plan.robot)
        found = judge(plan, robot, language, limits_of(plan, robot))
        assert found.kept, found


@pytest.mark.parametrize("language", ROBOTS)
def test_lines_and_an_arc_take_five_times_fewer_points_than_at_250_hz(language: str) -> None:
    robot = load_robot(ROBOTS[language][0])
    at = robot.fk(robot.home)
    quaternion = pin.Quaternion(at.rotation).coeffs().tolist()

    def place(y: float, z: float) -> dict[str, list[float]]:
        return {
            "position": (at.translation + np.array([0.0, y, z])).tolist(),
            "quaternion_xyzw": quaternion,
        }

    segments = [
        {"type": "line", "to": place(0.1, 0.0)},
        {"type": "arc", "via": place(0.15, -0.05)["position"], "to": place(0.1, -0.1)},
        {"type": "line", "to": place(0.0, -0.1)},
    ]
    path = {"begin": place(0.0, 0.0), "segments": segments}
    for speed in (0.1, 0.5):
        plan = ikplan.plan(
            {
                "robot": robot.name,
                "start": robot.home.tolist(),
                "path": path,
                "limits": {"tool_speed": speed},
            }
        )
        found = judge(plan, robot, language, limits_of(plan, robot))
        assert found.kept, found
        assert 5 * found.certificate.points <= 250.0 * plan.duration


@pytest.mark.parametrize("language", ROBOTS)
def test_a_program_that_is_tampered_with_leaves_its_bounds(
    language: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = moved(ROBOTS[language][0])
    robot = load_robot(plan.robot)
    limits = limits_of(plan, robot)
    assert judge(plan, robot, language, limits).kept
    text = encode(plan, language).decode()
    for pattern, change in (
        (
            r"(A3 |\[\[[^,]*,[^,]*,|J2= +|posj\([^,]*,[^,]*, |    \[[^,]*, [^,]*, "
            r"|    \(\d+, \[[^,]*, [^,]*, )(-?\d+\.\d+)",
            0.02,
        ),
        (r"(END=|T:=|P\[\d+\] |t=|\n    |    \((?=\d))(\d+(?:\.\d+|(?=msec|, \[)))", -0.01),
    ):
        found = list(re.finditer(pattern, text))
        middle = found[len(found) // 2]
        value = f"{float(middle[2]) + change:.3f}" if "." in middle[2] else "1"
        spoilt = text[: middle.start(2)] + value + text[middle.end(2) :]
        monkeypatch.setattr(
            "benchmarks.programs.points.encode", lambda *_, t=spoilt, **__: t.encode()
        )
        assert not judge(plan, robot, language, limits).kept


def test_rapid_counts_joint_3_of_a_parallelogram_from_the_base() -> None:
    for name, coupled in (("abb_irb2400_12_155", True), ("abb_irb6640_185_280", False)):
        plan = moved(name)
        played = rapid.play(encode(plan, "rapid").decode(), 0.004, still)
        expected = np.degrees(plan.q[[0, -1]])
        expected[:, 2] += expected[:, 1] if coupled else 0.0
        np.testing.assert_allclose(played.points[[0, -1]], expected, atol=1e-4)


def test_a_long_rapid_program_is_split_into_routines_without_a_stop() -> None:
    plan = moved("abb_irb6640_185_280")
    whole = encode(plan, "rapid").decode()
    assert plan.controller is not None
    language = LanguageInfo(name="rapid", variant="irc5", longest_program=5)
    controller = plan.controller.model_copy(update={"languages": [language]})
    split = encode(plan.model_copy(update={"controller": controller}), "rapid").decode()
    assert split.count("LOCAL PROC") > 1
    assert max(part.count("\\T:=") for part in split.split("ENDPROC")) == 5
    one, other = (rapid.play(text, 0.004, still) for text in (whole, split))
    np.testing.assert_array_equal(one.degrees, other.degrees)


def test_a_krl_program_longer_than_the_longest_is_refused_with_what_to_do() -> None:
    plan = moved("kuka_kr10_r1100_2")
    count = len(krl.play(encode(plan, "krl").decode(), 0.012).points)
    assert plan.controller is not None
    for longest, refused in ((count, False), (count - 1, True)):
        language = LanguageInfo(name="krl", variant="krc4", longest_program=longest)
        controller = plan.controller.model_copy(update={"languages": [language]})
        small = plan.model_copy(update={"controller": controller})
        if refused:
            with pytest.raises(InvalidRequest, match="in parts"):
                encode(small, "krl")
        else:
            encode(small, "krl")


@pytest.mark.parametrize("language", NAMED)
def test_a_program_is_named_as_its_file_and_the_same_plan_gives_the_same_bytes(
    language: str, tmp_path: Path
) -> None:
    plan = moved(ROBOTS[language][1])
    file = tmp_path / f"7 welds, on the left side of the door{SUFFIX[language]}"
    save(plan, file)
    again = tmp_path / "again" / file.name
    again.parent.mkdir()
    save(plan, again)
    assert file.read_bytes() == again.read_bytes()
    name = re.search(r"(?:DEF |PROC |/PROG  )(\w+)", file.read_text())
    assert name is not None
    assert name[1].lower().startswith("p_7_welds__on_the_left")
    assert len(name[1]) <= 32
    file.read_text(encoding="ascii")


@pytest.mark.parametrize("language", ROBOTS)
def test_a_coarser_tolerance_takes_fewer_points(language: str) -> None:
    plan = moved(ROBOTS[language][0])
    sizes = [len(encode(plan, language, tolerance=mm * 1e-3)) for mm in (0.01, 0.1, 1.0)]
    assert sizes[0] > sizes[1] >= sizes[2]
    with pytest.raises(InvalidRequest, match="no tolerance"):
        encode(plan, "csv", tolerance=1e-3)


def test_programs_are_for_the_arms_whose_controllers_run_them() -> None:
    for name, suffix, words in (
        ("ur5e", ".xarm.py", "controller runs none"),
        ("iiwa14", ".xarm.py", "no controller is known"),
        ("iiwa14", ".franky.py", "no controller is known"),
        ("ur5e", ".mod", "controller runs none"),
        ("abb_irb2400_12_155", ".src", "controller runs none"),
        ("kuka_lbr_iiwa14_r820", ".src", "no controller is known"),
    ):
        with pytest.raises(InvalidRequest, match=words):
            check_format(load_robot(name).info(), f"plan{suffix}")
    for language, names in ROBOTS.items():
        for name in names:
            check_format(load_robot(name).info(), f"plan{SUFFIX[language]}")


def test_an_arm_that_is_not_in_the_catalogue_is_given_with_the_plan() -> None:
    plan = moved("kuka_kr10_r1100_2")
    other = plan.model_copy(update={"robot": "mine"})
    with pytest.raises(InvalidRequest, match="not in the catalogue"):
        encode(other, "krl")
    assert b"mine" in encode(other, "krl", robot=load_robot(plan.robot))


def test_fanuc_programs_count_joint_3_from_the_horizontal() -> None:
    for name, coupled in (("fanuc_m10ia", True), ("fanuc_crx10ia_pendant", False)):
        plan = moved(name)
        played = fanuc.play(encode(plan, "fanuc-ls").decode(), 0.008)
        expected = np.degrees(plan.q[[0, -1]])
        expected[:, 2] -= expected[:, 1] if coupled else 0.0
        np.testing.assert_allclose(played.points[[0, -1]], expected, atol=1e-3)


def test_the_pendants_count_and_the_descriptions_give_the_same_fanuc_program() -> None:
    serial, counted = load_robot("fanuc_crx10ia"), load_robot("fanuc_crx10ia_pendant")
    q = np.array([0.1, 0.3, 0.5, 0.2, -0.4, 0.6])
    as_serial = q + np.array([0.0, 0.0, q[1], 0.0, 0.0, 0.0])
    assert serial.fk(as_serial).isApprox(counted.fk(q), 1e-9)


@pytest.mark.parametrize(("language", "points"), [("fanuc-ls", 12), ("drl", 12), ("franky", 12)])
def test_a_program_longer_than_the_longest_is_refused(language: str, points: int) -> None:
    plan = moved(ROBOTS[language][0])
    assert plan.controller is not None
    variant = VARIANTS[language][0]
    language_info = LanguageInfo(name=language, variant=variant, longest_program=points)
    controller = plan.controller.model_copy(update={"languages": [language_info]})
    with pytest.raises(InvalidRequest, match="in parts"):
        encode(plan.model_copy(update={"controller": controller}), language, tolerance=2e-5)


def test_a_tool_that_only_turns_has_no_drl_program() -> None:
    robot = load_robot("doosan_m1013")
    turned = [(robot.home + np.array([0.0, 0.0, 0.0, 0.0, 0.0, k])).tolist() for k in (0.0, 0.5, 1)]
    plan = ikplan.time_request({"robot": "doosan_m1013", "waypoints": turned})
    with pytest.raises(InvalidRequest, match="turns without moving"):
        encode(plan, "drl")


def test_a_move_of_more_than_32_s_has_no_fanuc_program() -> None:
    q = load_robot("fanuc_m10ia").home
    slow = ikplan.time_request(
        {
            "robot": "fanuc_m10ia",
            "waypoints": [q.tolist(), (q + np.array([0.4, 0.0, 0.0, 0.0, 0.0, 0.0])).tolist()],
            "limits": {"velocity_scale": 0.002},
        }
    )
    with pytest.raises(InvalidRequest, match="faster motion"):
        encode(slow, "fanuc-ls")


def test_a_language_has_its_own_variants() -> None:
    with pytest.raises(ValueError, match="rapid has the variants irc5"):
        ProgramLanguage(name="rapid", variant="krc4")
    with pytest.raises(ValueError, match="as many rows as columns"):
        ProgramLanguage(name="krl", variant="krc4", joints=[[1.0, 0.0]])


def test_the_interpreters_refuse_what_a_controller_would() -> None:
    text = encode(moved("abb_irb6640_185_280"), "rapid").decode()
    for old, new, words in (
        ("\\NoEOffs", "", "no such instruction"),
        ("ENDMODULE", "", "not a module"),
        (",ikplan_zone,", ",fine,", "a stop on the way"),
    ):
        with pytest.raises(ScriptError, match=words):
            rapid.play(text.replace(old, new), 0.004, still)
    text = encode(moved("fanuc_m10ia"), "fanuc-ls").decode()
    for old, new, words in (
        ("CNT100", "CNT50", "no such instruction"),
        ("UF : 0", "UF : 1", "not a position"),
        ("/END", "", "no end"),
        ("J1= ", "J1= 1e-9", "not a position"),
        ("  UTOOL_NUM=1 ;\r\n", " ;\r\n", "no such instruction"),
    ):
        with pytest.raises(ScriptError, match=words):
            fanuc.play(text.replace(old, new), 0.008)
    text = encode(moved("doosan_m1013"), "drl").decode()
    for old, new, words in (
        ("DUPLICATE", "OVERRIDE", "replace each other"),
        (", r=", ", r=1000+", "not a number"),
        (", r=", ", r=99", "larger than half"),
        ("posj(", "posx(", "six joint values"),
    ):
        with pytest.raises(ScriptError, match=words):
            drl.play(text.replace(old, new), 0.001, lambda _a, _b: 10.0)
    text = encode(moved("kuka_kr10_r1100_2"), "krl").decode()
    for old, new, words in (
        ("TIME_BLOCK START\r\n", "", "not one timed spline"),
        ("A1 ", "A1 1e-9", "not a number"),
        ("ENDSPLINE", "", "not one timed spline"),
    ):
        with pytest.raises(ScriptError, match=words):
            krl.play(text.replace(old, new), 0.012)
    text = encode(moved("xarm7"), "xarm").decode()
    for old, new, words in (
        ("set_mode(1)", "set_mode(0)", "code 9"),
        ("due + CYCLE", "due + CYCLE / 2", "before the cycle is over"),
        ("speed=10", "speed=100", "not a slow move"),
        ("k * CYCLE", "4 * k * CYCLE", "faster than the arm"),
        ("import bisect", "", "not a program"),
    ):
        with pytest.raises(ScriptError, match=words):
            xarm.play(text.replace(old, new), 0.004)
    fr3 = load_robot("fr3")
    assert fr3.jerk_limit is not None
    most = np.array([fr3.velocity_limit, fr3.acceleration_limit, fr3.jerk_limit])
    text = encode(moved("fr3"), "franky").decode()
    for old, new, words in (
        ("JERK = [5000", "JERK = [5001", "above the maker's"),
        ("APPROACH = 0.05", "APPROACH = 0.5", "not a slow move"),
        ("= 1.0", "= 0.9", "not one motion"),
        ("Duration(least)", "Duration(least + 0.5)", "whole milliseconds"),
        ("import sys", "", "not a program"),
    ):
        with pytest.raises(ScriptError, match=words):
            franky.play(text.replace(old, new), most)


def test_an_xarm_program_waits_out_a_pause_of_its_host_without_a_jump() -> None:
    text = encode(moved("lite6"), "xarm").decode()
    straight = xarm.play(text, 0.004)
    paused = xarm.play(
        text.replace(
            "        due = max(",
            "        if k == 20:\n            time.sleep(0.19)\n        due = max(",
        ),
        0.004,
    )
    np.testing.assert_array_equal(paused.degrees, straight.degrees)
    assert np.diff(paused.time).max() == pytest.approx(0.19, abs=0.005)
    assert np.diff(paused.time)[:-1].min() == pytest.approx(0.004, abs=1e-9)


def test_plans_of_arms_with_python_programs_are_as_without() -> None:
    # Their controllers say nothing of these languages, so that a plan's document does not change.
    for name in ("xarm7", "xarm6", "xarm5", "lite6"):
        assert load_robot(name).controller is None
    for name in ("panda", "fer", "fr3"):
        controller = load_robot(name).controller
        assert controller is not None
        assert controller.languages == []


def test_a_franky_program_needs_jerk_limits() -> None:
    plan = moved("fr3")
    assert plan.controller is not None
    controller = plan.controller.model_copy(
        update={"jerk": None, "languages": [LanguageInfo(name="franky", variant="franky-2")]}
    )
    with pytest.raises(InvalidRequest, match="no jerk limits"):
        encode(plan.model_copy(update={"controller": controller}), "franky")
