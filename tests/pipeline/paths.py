"""Requests that the tests of the pipeline plan."""

from __future__ import annotations

import copy
import functools
import json
import math
from pathlib import Path
from typing import Any

import pinocchio as pin

import ikplan
from ikplan import Plan

HELIX: dict[str, Any] = json.loads(
    (Path(__file__).parents[2] / "examples" / "helix_iiwa14.json").read_text()
)


def pose(T: pin.SE3) -> dict[str, Any]:
    """A pose as a waypoint."""
    xyzquat = pin.SE3ToXYZQUAT(T).tolist()
    return {"position": xyzquat[:3], "quaternion_xyzw": xyzquat[3:]}


def helix(**changes: Any) -> dict[str, Any]:
    """The helix of the demo, with other top-level fields."""
    return {**copy.deepcopy(HELIX), **changes}


def printed_helix() -> dict[str, Any]:
    """The helix as published (E1d): radius 0.20 m, phase 0."""
    document = helix()
    for k, waypoint in enumerate(document["path"]["waypoints"]):
        a = 4.0 * math.pi * k / 19.0
        waypoint["position"] = [
            0.60 + 0.20 * math.cos(a),
            0.20 * math.sin(a),
            0.10 + 0.50 * k / 19.0,
        ]
    return document


def on(robot: str, *waypoints: dict[str, Any], **fields: Any) -> dict[str, Any]:
    """A request for a robot and its waypoints."""
    return {"robot": robot, "path": {"waypoints": list(waypoints)}, **fields}


def lasting(plan: Plan) -> str:
    """A plan's document without ``stats``, which are outside of every promise."""
    return plan.model_dump_json(exclude={"stats"})


@functools.cache
def helix_plan(seed: int = 0, method: str = "ik-ba", elongation: str = "global") -> Plan:
    """The plan of the helix, made once."""
    ik = {"method": method, "seed": seed, "elongation": elongation}
    return ikplan.plan(helix(ik=ik))
