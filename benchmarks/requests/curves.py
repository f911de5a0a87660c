"""Random named curves about a tool pose, from large ones to those sharper than any tolerance."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from benchmarks.requests.limits import random_segment_limits
from ikplan.robots import Robot

__all__ = ["random_curves"]

Draws = np.random.Generator
Document = dict[str, Any]


def random_curves(rng: Draws, robot: Robot, T_base_tool: pin.SE3, free_start: bool) -> Document:
    """Draw a path of one to three curves, in the frame of a tool pose.

    Args:
        rng: Source of the numbers.
        robot: The robot.
        T_base_tool: Where the first curve begins about.
        free_start: Whether the start is not told: the path then needs a pose to begin at.

    Returns:
        The document of the path.
    """
    frame = pin.SE3ToXYZQUAT(T_base_tool).tolist()
    path: Document = {
        "frame": {"position": frame[:3], "quaternion_xyzw": frame[3:]},
        "segments": [_segment(rng, robot) for _ in range(rng.integers(1, 4))],
    }
    if free_start or rng.random() < 0.3:
        path["begin"] = {"position": [0.0, 0.0, 0.0], "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]}
    if rng.random() < 0.3:
        path["blend"] = float(rng.choice([1e-4, 0.001, 0.01]))
    if rng.random() < 0.25:
        kinds = ["all", {"about": "tool_z"}, {"about": "tool_x", "cone": 0.2}]
        path["orientation_free"] = kinds[int(rng.integers(3))]
    tolerance: Document = {}
    if rng.random() < 0.6:
        tolerance["position"] = float(rng.choice([1e-6, 1e-5, 1e-4, 1e-3]))
        tolerance["orientation"] = float(rng.choice([1e-4, 1e-3, 1e-2]))
    if rng.random() < 0.15:
        tolerance["box"] = {
            "position": rng.choice([0.0, 1e-3, 1e-2], 3).tolist(),
            "orientation": rng.choice([0.0, 0.05, 0.3], 3).tolist(),
            "frame": str(rng.choice(["tool", "path"])),
        }
        if isinstance(path.get("orientation_free"), dict):
            tolerance["box"]["orientation"] = [0.0, 0.0, 0.0]
    if tolerance:
        path["tolerance"] = tolerance
    return path


def _size(rng: Draws, least: float = 1e-4, most: float = 0.3) -> float:
    return float(np.exp(rng.uniform(np.log(least), np.log(most))))


def _segment(rng: Draws, robot: Robot) -> Document:
    size, signed = _size(rng), _size(rng) * float(rng.choice([-1.0, 1.0]))
    repeats = int(np.exp(rng.uniform(0.0, np.log(30.0))))
    sweep = float(rng.uniform(0.1, 7.0) * rng.choice([-1.0, 1.0]))
    kind = str(rng.choice(["circle", "helix", "rose", "sinusoid", "sawtooth", "trapezoid", "line"]))
    if kind == "line":
        to: Document = {"position": rng.uniform(-1, 1, 3).tolist()}
        to["position"] = [size * x for x in to["position"]]
        if rng.random() < 0.7:
            to["quaternion_xyzw"] = _turned(rng)
        segment: Document = {"type": kind, "to": to}
    else:
        drawn: dict[str, Document] = {
            "circle": {"radius": size, "angle": sweep},
            "helix": {"radius": size, "rise": signed, "turns": sweep},
            "rose": {"radius": size, "petals": min(repeats, 12)},
            "sinusoid": {"length": size, "amplitude": signed, "wavelength": size / repeats},
            "sawtooth": {"length": size, "height": signed, "teeth": repeats},
            "trapezoid": {"length": size, "height": signed, "periods": repeats},
        }
        segment = {"type": kind, **drawn[kind]}
        if kind == "sawtooth":
            segment["fall"] = float(rng.choice([0.0, 0.1, 0.5, 1.0]))
        elif kind == "trapezoid":
            segment["ramp"] = float(rng.choice([0.0, 0.01, 0.25, 0.5]))
        else:
            segment["phase"] = float(rng.choice([0.0, rng.uniform(-4, 4)]))
        rules: list[Any] = ["constant", "constant", "free", {"quaternion_xyzw": _turned(rng)}]
        if kind not in ("sawtooth", "trapezoid"):
            rules.append("follow")
        segment["orientation"] = rules[int(rng.integers(len(rules)))]
        if segment["orientation"] != "free" and rng.random() < 0.4:
            segment["quaternion_xyzw"] = _turned(rng)
        if rng.random() < 0.3:
            segment["frame"] = {
                "position": (0.1 * rng.uniform(-1, 1, 3)).tolist(),
                "quaternion_xyzw": _turned(rng),
            }
    if rng.random() < 0.2:
        segment["limits"] = random_segment_limits(rng, robot)
    return segment


def _turned(rng: Draws) -> list[float]:
    spread = float(rng.choice([0.05, 0.5]))
    turn = pin.Quaternion(pin.exp3(spread * rng.normal(size=3)))
    return [float(x) for x in turn.coeffs()]
