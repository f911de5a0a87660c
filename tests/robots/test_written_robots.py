"""Robots written from facts: their files, held against what their sources publish."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from statistics import median

import numpy as np
import pytest

from benchmarks.catalogue.measure import fk_errors, lines_planned, poses_solved, serial_values
from catalogue.__main__ import ROOT, written
from catalogue.documents import robot_document
from catalogue.facts import Arm, CountedJoint, FactsJoint, read_facts
from ikplan.robots import load_robot
from ikplan.robots.definition.defaults import ACCELERATION_DEFAULTS, DEFAULT_ACCELERATION
from tests.present import present

from .test_controllers import HALF_PI, dh

FACTS = read_facts()
ARMS = {arm.name: arm for arm in FACTS.arms}
each = pytest.mark.parametrize("arm", ARMS.values(), ids=ARMS)


def test_files_are_what_the_facts_say() -> None:
    assert len(ARMS) >= 60
    differing = [
        str(path)
        for path, text in written().items()
        if (ROOT / path).read_text(encoding="utf-8") != text
    ]
    assert differing == [], "run python -m catalogue"


def test_a_file_that_says_otherwise_is_told(tmp_path: Path) -> None:
    """The check sees a changed figure, and writes nothing."""
    code = (
        "import sys; from pathlib import Path; import catalogue.__main__ as m; "
        f"m.ROOT = Path({str(tmp_path)!r}); m.written = lambda: {{Path('a'): 'new'}}; "
        "sys.exit(m.main(['--check']))"
    )
    (tmp_path / "a").write_text("old")
    run = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (run.returncode, run.stdout) == (1, "a\n")
    assert (tmp_path / "a").read_text() == "old"


def test_every_file_that_says_it_is_written_is() -> None:
    marked = {
        file.parent.name
        for file in (ROOT / "robots").glob("*/robot.yaml")
        if "python -m catalogue" in file.read_text(encoding="utf-8").splitlines()[0]
    }
    assert marked == set(ARMS)


@each
def test_the_tool_is_where_the_facts_have_it(arm: Arm) -> None:
    position, rotation = fk_errors(arm, load_robot(arm.name), 50, np.random.default_rng(1))
    assert position <= 1e-6
    assert rotation <= 1e-6


@each
def test_limits_are_the_published_ones(arm: Arm) -> None:
    robot = load_robot(arm.name)
    joints: Sequence[FactsJoint | CountedJoint] = (
        arm.joints if arm.counting is None else arm.counting.joints
    )
    assert list(robot.joint_names) == [joint.name for joint in joints]
    for i, joint in enumerate(joints):
        assert robot.lower[i] == (-np.inf if joint.lower is None else joint.lower)
        assert robot.upper[i] == (np.inf if joint.upper is None else joint.upper)
        assert robot.velocity_limit[i] == joint.velocity
        published = arm.joints[i].acceleration
        default = ACCELERATION_DEFAULTS[DEFAULT_ACCELERATION](joint.velocity)
        assert robot.acceleration_limit[i] == (default if published is None else published)
    notes = " ".join(robot.info().notes)
    assert ("not official" in notes) != FACTS.source_of(arm).official


def test_the_default_acceleration_is_below_the_median_of_what_makers_publish() -> None:
    """Each arm in facts.yaml with the makers' own accelerations counts, Franka's aside."""
    ratios = [
        joint.acceleration / joint.velocity
        for arm in ARMS.values()
        if arm.acceleration_file is not None
        for joint in arm.joints
        if joint.acceleration is not None
    ]
    assert len(ratios) == 305
    assert median(ratios) == pytest.approx(1.697, abs=1e-3)
    assert ACCELERATION_DEFAULTS[DEFAULT_ACCELERATION](1.0) <= median(ratios)


@each
def test_home_is_in_the_middle_of_the_ranges_and_far_from_singular(arm: Arm) -> None:
    robot = load_robot(arm.name)
    lower, upper = np.maximum(robot.lower, -np.pi), np.minimum(robot.upper, np.pi)
    bounded = np.isfinite(robot.lower)
    margin = 0.15 * np.where(bounded, robot.upper - robot.lower, upper - lower)
    assert (robot.home >= np.where(bounded, robot.lower, -np.pi) + margin).all()
    assert (robot.home <= np.where(bounded, robot.upper, np.pi) - margin).all()
    least = np.linalg.svd(robot.jacobian(robot.home), compute_uv=False)[-1]
    reach = sum(np.linalg.norm(joint.xyz) for joint in arm.joints)
    assert least > 0.1 * min(1.0, reach)


@each
def test_poses_are_solved(arm: Arm) -> None:
    """A sample of ``python -m benchmarks.catalogue``, which solves 200 of 200 for each."""
    assert poses_solved(load_robot(arm.name), 3, np.random.default_rng(2)) == 3


@pytest.mark.parametrize(
    ("name", "direction"),
    [
        ("ur20", "+x"),
        ("fer", "-z"),
        ("xarm5", "+z"),
        ("doosan_p3020", "-x"),
        ("doosan_m1013", "-x"),
        ("kuka_kr210_r2700_2", "+z"),
        ("kinova_gen3_7", "-z"),
        ("fanuc_crx10ia_pendant", "+x"),
        ("denso_hsr065", "+z"),
    ],
)
def test_a_line_from_home_is_planned(name: str, direction: str) -> None:
    assert lines_planned(name, [direction]) == {direction: "planned"}


# The makers' tables, standard: rows of a, d [m], alpha, theta offset [rad].
XARM_A2 = float(np.hypot(0.2845, 0.0535))
XARM_T2 = float(np.arctan2(0.2845, 0.0535))
XARM_A3 = float(np.hypot(0.3425, 0.0775))
XARM_T3 = float(np.arctan2(0.3425, 0.0775))
TABLES: dict[str, list[tuple[float, float, float, float]]] = {
    "ur20": [
        (0, 0.2363, HALF_PI, 0), (-0.862, 0, 0, 0), (-0.7287, 0, 0, 0), (0, 0.201, HALF_PI, 0),
        (0, 0.1593, -HALF_PI, 0), (0, 0.1543, 0, 0),
    ],
    "xarm5": [
        (0, 0.267, -HALF_PI, 0), (XARM_A2, 0, 0, -XARM_T2), (XARM_A3, 0, 0, XARM_T2 + XARM_T3),
        (0.076, 0, -HALF_PI, -XARM_T3), (0, 0.097, 0, 0),
    ],
}  # fmt: skip


@pytest.mark.parametrize("name", TABLES)
def test_the_chain_is_the_makers_dh_table(name: str) -> None:
    robot = load_robot(name)
    turned = np.diag([-1.0, -1.0, 1.0, 1.0]) if name.startswith("ur") else np.eye(4)
    rng = np.random.default_rng(8)
    for _ in range(50):
        q = robot.random_configuration(rng)
        T = turned
        for value, (a, d, alpha, offset) in zip(q, TABLES[name], strict=True):
            T = T @ dh(value + offset, a, d, alpha)
        np.testing.assert_allclose(robot.fk(q).homogeneous, T, atol=1e-8, rtol=0)


def test_fer_is_panda_without_its_hand() -> None:
    fer, panda = load_robot("fer"), load_robot("panda", tip="panda_link8")
    rng = np.random.default_rng(9)
    for _ in range(20):
        q = fer.random_configuration(rng)
        np.testing.assert_allclose(fer.fk(q).homogeneous, panda.fk(q).homogeneous, atol=1e-8)
    np.testing.assert_array_equal(fer.acceleration_limit, panda.acceleration_limit)
    assert fer.jerk_limit is not None
    np.testing.assert_array_equal(fer.jerk_limit, panda.jerk_limit)


def test_the_pendant_of_the_crx_counts_the_forearm_from_the_horizontal() -> None:
    serial, pendant = load_robot("fanuc_crx10ia"), load_robot("fanuc_crx10ia_pendant")
    arm = ARMS["fanuc_crx10ia_pendant"]
    rng = np.random.default_rng(10)
    for _ in range(50):
        q = pendant.random_configuration(rng)
        own = serial_values(arm, q)
        assert own[2] == pytest.approx(q[1] + q[2])
        np.testing.assert_allclose(pendant.fk(q).homogeneous, serial.fk(own).homogeneous, atol=1e-9)
    # J2 moves the upper arm and carries the forearm along without turning it.
    J = pendant.jacobian(pendant.home)
    np.testing.assert_allclose(J[3:, 1], 0.0, atol=1e-12)


def test_every_motion_of_the_pendants_joints_keeps_the_limits_of_the_arm() -> None:
    serial, pendant = load_robot("fanuc_crx10ia"), load_robot("fanuc_crx10ia_pendant")
    matrix = np.array(present(ARMS["fanuc_crx10ia_pendant"].counting).matrix)
    positive, negative = np.maximum(matrix, 0.0), np.minimum(matrix, 0.0)
    room = 1e-12
    assert (positive @ pendant.upper + negative @ pendant.lower <= serial.upper + room).all()
    assert (positive @ pendant.lower + negative @ pendant.upper >= serial.lower - room).all()
    for limit in ("velocity_limit", "acceleration_limit"):
        most = np.abs(matrix) @ getattr(pendant, limit)
        assert (most <= getattr(serial, limit) * (1.0 + 1e-12)).all()


@pytest.mark.parametrize("field", ["official", "acceleration"])
def test_what_the_facts_say_stands_in_the_document(field: str) -> None:
    arm = ARMS["kuka_kr4_r600"]
    if field == "official":
        source = FACTS.sources["kuka"].model_copy(update={"official": False})
        facts = FACTS.model_copy(update={"sources": {**FACTS.sources, "kuka": source}})
        assert "not official" in robot_document(facts, arm)
    else:
        joints = [j.model_copy(update={"acceleration": None}) for j in arm.joints]
        plain = arm.model_copy(update={"joints": joints, "acceleration_file": None})
        assert f"acceleration: {{default: {DEFAULT_ACCELERATION}}}" in robot_document(FACTS, plain)


@pytest.mark.parametrize("joint", range(6))
def test_a_joint_two_micrometres_off_is_seen(joint: int) -> None:
    arm = ARMS["kuka_kr4_r600"]
    x, y, z = arm.joints[joint].xyz
    joints = list(arm.joints)
    joints[joint] = joints[joint].model_copy(update={"xyz": (x + 2e-6, y, z)})
    other = arm.model_copy(update={"joints": joints})
    position, _ = fk_errors(other, load_robot(arm.name), 3, np.random.default_rng(3))
    assert position == pytest.approx(2e-6, rel=1e-2)
