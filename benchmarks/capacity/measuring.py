"""Service times of this machine: processor time and size of plans, and of poses."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np
import zstandard

import ikplan
from benchmarks.batches.requests import request_lines
from ikplan.errors import IkplanError

__all__ = ["FILE", "measure"]

FILE = Path(__file__).with_name("service_times.json")
_WARM = 4
_POSES = 4000


def measure(plans: int) -> dict[str, Any]:
    """Plan the first lines of the batch benchmark, and solve poses with and without solutions.

    Args:
        plans: How many plans.

    Returns:
        Processor time [ms] and size [bytes] of each plan, its size compressed, and the processor
        time of a pose [ms].
    """
    lines = [json.loads(line) for line in request_lines(plans + _WARM)]
    for line in lines[:_WARM]:
        ikplan.plan(line)
    milliseconds, sizes, packed = [], [], []
    compressor = zstandard.ZstdCompressor(level=3)
    for line in lines[_WARM:]:
        begun = time.process_time()
        try:
            document = ikplan.plan(line).model_dump_json().encode()
        except IkplanError as error:
            document = json.dumps({"problem": str(error)}).encode()
        milliseconds.append(round(1e3 * (time.process_time() - begun), 3))
        sizes.append(len(document))
        packed.append(len(compressor.compress(document)))
    return {
        "plan_ms": milliseconds,
        "plan_bytes": int(np.mean(sizes)),
        "plan_bytes_zstd": int(np.mean(packed)),
        **_poses(),
    }


def _poses() -> dict[str, float]:
    """Processor time a pose of ur5, reached from home, and out of reach without a verdict [ms]."""
    robot = ikplan.load_robot("ur5")
    rng = np.random.default_rng(0)
    q = rng.uniform(robot.lower, robot.upper, (_POSES, robot.dof))
    R, p = robot.poses(q)
    poses = np.tile(np.eye(4), (_POSES, 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = R, p
    # Half a metre up: many are then out of reach, few by a glance at the shoulder.
    raised = poses.copy()
    raised[:, 2, 3] += 0.5
    ikplan.solve_ik_batch(robot, poses[:8], verdict=False, threads=1)
    found = {}
    for name, asked in (("reached", poses), ("raised", raised)):
        begun = time.process_time()
        solved = ikplan.solve_ik_batch(robot, asked, verdict=False, threads=1).solved
        found[name] = 1e3 * (time.process_time() - begun) / _POSES
        found[f"{name}_share"] = float(solved.mean())
    hit, missed = found["reached"], 1.0 - found["raised_share"]
    refused = (found["raised"] - hit * found["raised_share"]) / max(missed, 1e-9)
    return {"pose_reached_ms": round(hit, 4), "pose_refused_ms": round(refused, 4)}
