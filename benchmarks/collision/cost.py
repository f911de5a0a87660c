"""What a proof costs, beside sampled checks by coal."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

import ikplan
from benchmarks.collision.drawing import box, rotation
from benchmarks.collision.meshes import mesh_bodies
from benchmarks.collision.oracle import Oracle
from ikplan.certificate.clearance import ClearanceProof, JointCurve
from ikplan.errors import IkplanError
from ikplan.robots import Robot
from ikplan.scene.body import Body, CollisionModel

__all__ = ["ProofCost", "proof_costs"]

Array = NDArray[np.float64]

BOXES = 10
DURATION = 5.0
RATE = 250.0


@dataclass(frozen=True)
class ProofCost:
    """What one motion costs [ms], processor time.

    Attributes:
        proven: Whether it is proven free.
        least: Distance proven [m].
        pairs: Pairs of pieces.
        prepare: Reading the bodies, once a robot and scene.
        polynomials: Proof of the plan's polynomials, to 1 mm.
        cubic: Proof of the cubics between samples, to 1 mm.
        segments: Proof of ten segments one by one, to 1 mm each.
        sampled: coal's yes or no at every sample, pair by pair.
        broadphase: The same with a broadphase.
        configurations: Configurations of the proof of the polynomials.
        queries: Its distance queries.
    """

    proven: bool
    least: float
    pairs: int
    prepare: float
    polynomials: float
    cubic: float
    segments: float
    sampled: float
    broadphase: float
    configurations: int
    queries: int


def with_boxes(
    robot: Robot, model: CollisionModel, rng: np.random.Generator, motion: Array
) -> CollisionModel:
    """Add boxes to a robot's bodies, none nearer than 2 cm to it at a few joint values."""
    bodies, pairs = list(model.bodies), model.pairs.tolist()
    links = [k for k, body in enumerate(model.bodies) if body.carrier > 0]
    while len(bodies) < len(model.bodies) + BOXES:
        piece = box(rng.uniform(-0.9, 0.9, 3), rng.uniform(0.05, 0.4, 3), rotation(rng))
        body = Body(f"box {len(bodies)}", 0, (piece,), kind="obstacle")
        new = [(k, len(bodies)) for k in links]
        tried = CollisionModel((*bodies, body), np.array(new, dtype=np.int64), 0.0)
        oracle = Oracle(robot, tried)
        if min(oracle.distances(q).min() for q in motion) > 0.02:
            bodies.append(body)
            pairs += new
    return CollisionModel(tuple(bodies), np.array(pairs, dtype=np.int64), 0.0)


def _milliseconds(work: Callable[[], object], repeats: int) -> float:
    times = []
    for _ in range(repeats):
        begin = time.process_time()
        work()
        times.append(1e3 * (time.process_time() - begin))
    return float(np.median(times))


def proof_costs(name: str, count: int, seed: int = 0) -> list[ProofCost]:
    """Measure motions of 5 s of the project's own, free at 40 of their samples."""
    robot, model = mesh_bodies(name)
    alone = Oracle(robot, model)
    found: list[ProofCost] = []
    rng = np.random.default_rng(seed)
    while len(found) < count:
        q = np.array([robot.random_configuration(rng) for _ in range(4)])
        q = robot.home + 0.5 * (q - robot.home)
        try:
            share = _timed(robot, q, 1.0, "samples").duration / DURATION
            if share > 1.0:
                continue
            plan, exact = (_timed(robot, q, share, form) for form in ("samples", "polynomial"))
        except IkplanError:
            continue
        some = plan.q[:: max(len(plan.q) // 40, 1)]
        if min(alone.distances(row).min() for row in some) <= 0.0:
            continue
        scene = with_boxes(robot, model, rng, some)
        found.append(_cost(robot, scene, plan, exact))
    return found


def _timed(robot: Robot, q: Array, share: float, form: str) -> ikplan.Plan:
    request = {
        "robot": robot.name,
        "waypoints": q.tolist(),
        "limits": {"jerk": False, "velocity_scale": share, "acceleration_scale": share**2},
        "sampling": {"rate_hz": RATE, "form": form},
    }
    return ikplan.time_request(request, robot=robot)


def _cost(robot: Robot, scene: CollisionModel, plan: ikplan.Plan, exact: ikplan.Plan) -> ProofCost:
    proof = ClearanceProof(robot, scene)
    assert exact.motion is not None
    polynomials = JointCurve.of_motion(exact.motion)
    cubic = JointCurve.of_samples(plan.time, plan.q, plan.dq)
    edges = np.linspace(0.0, plan.duration, 11)
    times = list(zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True))
    result = proof.prove(polynomials)
    oracle = Oracle(robot, scene)
    rows = robot.configurations(plan.q)
    manager = pin.BroadPhaseManager_DynamicAABBTreeCollisionManager(
        robot.model, oracle.geometry, oracle.geometry_data
    )

    def sampled() -> None:
        for row in rows:
            if pin.computeCollisions(
                robot.model, oracle.data, oracle.geometry, oracle.geometry_data, row, True
            ):
                return

    def broadphase() -> None:
        for row in rows:
            if pin.computeCollisions(robot.model, oracle.data, manager, row, True):
                return

    least = result.clearance.least
    return ProofCost(
        result.proven,
        0.0 if least is None else least,
        len(proof.pairs.group),
        _milliseconds(lambda: ClearanceProof(robot, scene), 3),
        _milliseconds(lambda: proof.prove(polynomials), 7),
        _milliseconds(lambda: proof.prove(cubic), 7),
        _milliseconds(lambda: proof.prove(polynomials, segment_times=times), 7),
        _milliseconds(sampled, 1),
        _milliseconds(broadphase, 1),
        result.configurations,
        result.queries,
    )
