"""The certificate of an honest plan holds; every broken promise is found and named."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan import CertificateViolated, load_robot
from ikplan.certificate import Claim, certify
from ikplan.documents.limits import LimitOptions
from ikplan.documents.path import PathRequest
from ikplan.documents.plan_request import PlanRequest
from ikplan.joint_path import JointPath
from ikplan.limits import JointLimits
from ikplan.limits.motion_limits import MotionLimits
from ikplan.robots import Robot
from ikplan.timing import on_grid, sample, time_joint_path

DOWN = [1.0, 0.0, 0.0, 0.0]
REQUEST: dict[str, Any] = {
    "robot": "iiwa14",
    "path": {
        "frame": {"position": [0.1, -0.05, 0.1], "quaternion_xyzw": [0.0, 0.0, 0.1, 0.995]},
        "waypoints": [
            {"position": [0.45, 0.05, 0.3], "quaternion_xyzw": DOWN},
            {"position": [0.5, 0.15, 0.35]},
            {"position": [0.4, 0.2, 0.4], "quaternion_xyzw": DOWN},
        ],
    },
    "tool": {"position": [0.0, 0.02, 0.1]},
}


def as_document() -> dict[str, Any]:
    c = (1.0 - 0.1**2) ** 0.5
    path = {**REQUEST["path"]}
    path["frame"] = {**path["frame"], "quaternion_xyzw": [0.0, 0.0, 0.1, c]}
    return {**REQUEST, "path": path}


@pytest.fixture(scope="module")
def honest() -> Claim:
    """A plan, taken apart."""
    request = PlanRequest(**as_document())
    plan = ikplan.plan(request)
    robot = load_robot("iiwa14").with_tool(request.tool.position)
    t = plan.trajectory
    return Claim(
        robot,
        request.path,
        np.array(robot.home),
        np.array(plan.waypoints.q),
        np.array(plan.waypoints.time),
        np.array(t.time),
        np.array(t.q),
        np.array(t.dq),
        np.array(t.ddq),
        limits_of(robot),
    )


def limits_of(robot: Robot, **options: float) -> MotionLimits:
    return MotionLimits.of(robot, LimitOptions.model_validate(options))


def path_of(c: Claim) -> PathRequest:
    """The path of a claim that is of one."""
    assert c.path is not None
    return c.path


def test_an_honest_plan_is_certified_with_figures_that_pinocchio_confirms(honest: Claim) -> None:
    c = certify(honest)
    robot = honest.robot
    path = path_of(honest)
    frame = path.frame
    T = pin.XYZQUATToSE3(np.array([*frame.position, *frame.quaternion_xyzw]))
    distances, turns = [], []
    for q, w in zip(honest.waypoint_q, path.waypoints or (), strict=True):
        have, want = robot.fk(q), T.act(np.array(w.position))
        distances.append(np.linalg.norm(have.translation - want))
        if w.quaternion_xyzw:
            R = T.rotation @ pin.Quaternion(np.array(w.quaternion_xyzw)).toRotationMatrix()
            turns.append(np.linalg.norm(pin.log3(have.rotation.T @ R)))
    assert c.max_position_error == pytest.approx(max(distances), abs=1e-15)
    assert c.max_orientation_error == pytest.approx(max(turns), abs=1e-13)
    velocity = np.abs(honest.dq) / robot.velocity_limit
    assert c.velocity_limit_ratio == pytest.approx(velocity.max())
    row, joint = np.unravel_index(velocity.argmax(), velocity.shape)
    assert c.velocity_limit_at.joint == robot.joint_names[joint]
    assert c.velocity_limit_at.time == honest.time[row]
    acceleration = np.abs(honest.ddq) / robot.acceleration_limit
    assert c.acceleration_limit_ratio == pytest.approx(acceleration.max())
    half, middle = (robot.upper - robot.lower) / 2, (robot.upper + robot.lower) / 2
    assert c.position_limit_ratio == pytest.approx((np.abs(honest.q - middle) / half).max())
    assert honest.q_start is not None
    steps = np.diff(np.vstack([honest.q_start, honest.waypoint_q]), axis=0)
    assert c.elongation_sum == pytest.approx(np.linalg.norm(steps, axis=1).sum())
    assert 0.0 < c.elongation_lower_bound <= c.elongation_sum
    least = min(np.linalg.svd(robot.jacobian(q))[1][-1] for q in honest.q)
    assert c.min_singular_value == pytest.approx(least, rel=1e-9)
    assert c.max_path_deviation is None


def test_joint_waypoints_have_no_pose_errors(honest: Claim) -> None:
    c = certify(replace(honest, path=None))
    assert c.max_position_error is None
    assert c.max_orientation_error is None
    assert c.elongation_lower_bound == c.elongation_sum


def changed(a: np.ndarray | None, where: Any, by: Any) -> np.ndarray:
    assert a is not None
    b = a.copy()
    b[where] += by
    return b


def scaled_time(c: Claim, k: float) -> Claim:
    """The whole motion k times as long."""
    return replace(
        c, time=k * c.time, waypoint_time=k * c.waypoint_time, dq=c.dq / k, ddq=c.ddq / k**2
    )


def elsewhere(c: Claim, metres: float) -> Claim:
    """The same motion for a path that is somewhere else."""
    path = path_of(c)
    frame = path.frame
    moved = frame.model_copy(update={"position": [frame.position[0] + metres, *frame.position[1:]]})
    return replace(c, path=path.model_copy(update={"frame": moved}))


def turned(c: Claim) -> Claim:
    """The same motion for a path with one waypoint turned by 0.02 rad."""
    path = path_of(c)
    assert path.waypoints is not None
    first = path.waypoints[0].model_copy(
        update={"quaternion_xyzw": [np.cos(0.01), np.sin(0.01), 0.0, 0.0]}
    )
    waypoints = [first, *path.waypoints[1:]]
    return replace(c, path=path.model_copy(update={"waypoints": waypoints}))


def cut(c: Claim, row: int) -> Claim:
    """A sample taken out, so that the next comes too early."""
    keep = np.arange(len(c.time)) != row
    time = np.concatenate([c.time[:row], c.time[row:-1]])
    return replace(c, time=time, q=c.q[keep], dq=c.dq[keep], ddq=c.ddq[keep])


TAMPERED: dict[str, tuple[str, Callable[[Claim], Claim]]] = {
    "a joint jumps": ("positions jump", lambda c: replace(c, q=changed(c.q, (40, 2), 1e-3))),
    "a joint jumps and stays": (
        "positions jump",
        lambda c: replace(c, q=changed(c.q, (slice(40, -1), 3), 0.02)),
    ),
    "a velocity jumps": ("velocities jump", lambda c: replace(c, dq=changed(c.dq, (30, 1), 0.2))),
    "velocities are all zero": (
        "positions jump",
        lambda c: replace(c, dq=np.zeros_like(c.dq), ddq=np.zeros_like(c.ddq)),
    ),
    "a sample is missing": ("positions jump", lambda c: cut(c, len(c.time) // 2)),
    "too fast": ("velocity limit of", lambda c: scaled_time(c, 0.9)),
    "velocity scaled": (
        "velocity limit of",
        lambda c: replace(c, limits=limits_of(c.robot, velocity_scale=0.9)),
    ),
    "acceleration scaled": (
        "acceleration limit of",
        lambda c: replace(c, limits=limits_of(c.robot, acceleration_scale=0.9)),
    ),
    "an acceleration is out": (
        "acceleration limit of A2",
        lambda c: replace(c, ddq=changed(c.ddq, (10, 1), 50.0)),
    ),
    "outside the position limits": (
        "position limit of A4",
        lambda c: replace(c, q=changed(c.q, (slice(None), 3), -1.5)),
    ),
    "another start": (
        "the start asked for",
        lambda c: replace(c, q_start=changed(c.q_start, 0, 1e-12)),
    ),
    "another end": (
        "the last waypoint",
        lambda c: replace(c, waypoint_q=changed(c.waypoint_q, (-1, 0), 1e-12)),
    ),
    "another waypoint": (
        "not passed at its time",
        lambda c: replace(c, waypoint_q=changed(c.waypoint_q, (0, 5), 1e-3)),
    ),
    "a waypoint passed later": (
        "not passed at its time",
        lambda c: replace(c, waypoint_time=changed(c.waypoint_time, 0, 0.02)),
    ),
    "a waypoint after the end": (
        "waypoint times do not increase",
        lambda c: replace(c, waypoint_time=changed(c.waypoint_time, -1, 1e-3)),
    ),
    "waypoints out of order": (
        "waypoint times do not increase",
        lambda c: replace(c, waypoint_time=c.waypoint_time[[1, 0, 2]]),
    ),
    "time stands still": (
        "sample times do not increase",
        lambda c: replace(c, time=changed(c.time, 20, c.time[19] - c.time[20])),
    ),
    "time starts later": (
        "sample times do not increase",
        lambda c: replace(c, time=c.time + 0.1, waypoint_time=c.waypoint_time + 0.1),
    ),
    "not at rest at the end": (
        "begin and end at rest",
        lambda c: replace(c, dq=changed(c.dq, (-1, 0), 1e-12)),
    ),
    "not at rest at the start": (
        "begin and end at rest",
        lambda c: replace(c, dq=changed(c.dq, (0, 6), 1e-12)),
    ),
    "a path elsewhere": ("missed by 0.001 m", lambda c: elsewhere(c, 1e-3)),
    "an orientation elsewhere": ("missed by 0.02 rad", turned),
    "NaN in q": ("finite in q", lambda c: replace(c, q=changed(c.q, (5, 0), np.nan))),
    "NaN in dq": ("finite in dq", lambda c: replace(c, dq=changed(c.dq, (5, 0), np.nan))),
    "NaN in ddq": ("finite in ddq", lambda c: replace(c, ddq=changed(c.ddq, (5, 0), np.nan))),
    "NaN in time": ("finite in time", lambda c: replace(c, time=changed(c.time, 5, np.nan))),
    "infinity at a waypoint": (
        "finite in waypoint_q",
        lambda c: replace(c, waypoint_q=changed(c.waypoint_q, (0, 0), np.inf)),
    ),
}


@pytest.mark.parametrize("name", TAMPERED)
def test_a_broken_promise_is_found_and_named(name: str, honest: Claim) -> None:
    says, tamper = TAMPERED[name]
    with pytest.raises(CertificateViolated) as caught:
        certify(tamper(honest))
    error = caught.value
    assert any(says in violation for violation in error.violations), error.violations
    assert says in error.detail
    if error.certificate:
        assert error.certificate["valid"] is False


def test_a_tolerance_covers_what_it_says(honest: Claim) -> None:
    missed = elsewhere(honest, 1e-3)
    with pytest.raises(CertificateViolated, match="missed"):
        certify(missed)
    path = path_of(missed)
    wide = path.tolerance.model_copy(update={"position": 1.001e-3})
    path = path.model_copy(update={"tolerance": wide})
    c = certify(replace(missed, path=path))
    assert c.max_position_error == pytest.approx(1e-3, rel=1e-6)


@pytest.mark.parametrize("name", ["kinova_j2s6s200", "tiago", "dobot_magician", "so101"])
@pytest.mark.parametrize("rate_hz", [5.0, 250.0])
def test_honest_joint_motions_of_every_kind_of_robot_are_certified(
    name: str, rate_hz: float
) -> None:
    robot = load_robot(name)
    limits = JointLimits.from_robot(robot, 0.7, 0.6)
    rng = np.random.default_rng(72)
    for n in (1, 2, 6):
        q = np.array([robot.random_configuration(rng) for _ in range(n)])
        timed = on_grid(time_joint_path(JointPath.through(q, limits), limits), rate_hz)
        s = sample(timed, rate_hz)
        allowed = limits_of(robot, velocity_scale=0.7, acceleration_scale=0.6)
        c = certify(Claim(robot, None, q[0], q, timed.times, s.time, s.q, s.dq, s.ddq, allowed))
        assert c.velocity_limit_ratio <= 1.0 + 1e-9
        assert (c.position_limit_at is None) == bool(robot.continuous.all())


SOURCE = Path(ikplan.__file__).parent


def imported(module: str, seen: set[str]) -> set[str]:
    """Every module of ikplan that ``module`` imports, lazily or not, directly or not."""
    file = SOURCE.parent / (module.replace(".", "/") + ".py")
    if not file.is_file():
        file = SOURCE.parent / module.replace(".", "/") / "__init__.py"
    if module in seen or not file.is_file():
        return seen
    seen.add(module)
    for node in ast.walk(ast.parse(file.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names] + [str(node.module)]
        else:
            continue
        for name in names:
            if name.split(".")[0] == "ikplan" and name != "ikplan":
                imported(name, seen)
    return seen


def test_the_certificate_shares_no_code_with_the_planner() -> None:
    """Documents, limits, robots, errors and array types: the request, not how it is planned.

    What compiles kernels is shared too, and the constant that documents name the budget by.
    """
    rooms = {name.split(".")[1] for name in imported("ikplan.certificate", set())}
    allowed = {"_lazy", "arrays", "certificate", "documents", "errors", "limits", "robots"}
    allowed |= {"_jit", "_kernels", "processor_time"}
    assert rooms <= allowed
    assert {"documents", "robots"} <= rooms
    proof = {name.split(".")[1] for name in imported("ikplan.certificate.clearance", set())}
    assert proof <= allowed | {"scene"}
