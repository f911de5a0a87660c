"""Requests whose path, or a part of it, leads nowhere or all but nowhere."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin
from numpy.typing import NDArray

from ikplan import load_robot

Array = NDArray[np.float64]
Document = dict[str, Any]

START = [0.4, -1.2, 1.5, -0.8, -1.2, 0.3]
ROBOT = load_robot("ur5")
T0 = ROBOT.fk(START)
FORMS: tuple[Document, ...] = (
    {"form": "samples"},
    {"form": "knots"},
    {"form": "polynomial"},
    {"rate_hz": 1000.0},
)
STARTS = ("given", "free", "joint")


def pose(T: pin.SE3, oriented: bool = True) -> Document:
    x = pin.SE3ToXYZQUAT(T).tolist()
    turn = {"quaternion_xyzw": x[3:]} if oriented else {}
    return {"position": x[:3], **turn}


def moved(by: Any, turn: Any = (0.0, 0.0, 0.0)) -> pin.SE3:
    """The pose at the start, moved [m] in the base and turned [rad] about its own axes."""
    R = T0.rotation @ pin.exp3(np.array(turn, dtype=np.float64))
    return pin.SE3(R, T0.translation + np.array(by, dtype=np.float64))


def rounded(digits: int) -> Document:
    """The pose at the start, written with so many digits after the point."""
    return {key: [round(x, digits) for x in row] for key, row in pose(T0).items()}


HERE = pose(T0)
FAR = pose(moved([0.02, -0.01, 0.015], [0.05, 0.02, -0.04]))
FARTHER = pose(moved([0.03, 0.02, -0.01], [-0.05, 0.03, 0.02]))


def near(size: float, number: int) -> Document:
    """A pose so far from that at the start [m], in the direction of that number."""
    direction = np.random.default_rng(number).normal(size=3)
    return pose(moved(size * direction / np.linalg.norm(direction)))


def _curve(kind: str, size: float, first: tuple[float, float], **shape: Any) -> list[Document]:
    """A curve with its first point, at ``first`` in its frame, so far from the start."""
    u = np.array([0.6, -0.48, 0.64])
    origin = T0.translation + size * u - np.array([*first, 0.0])
    return [{"type": kind, "frame": {"position": origin.tolist()}, **shape}]


def parts(size: float) -> dict[str, list[Document]]:
    """Segments of every type about as long as a size [m, rad], or that much away at their begin."""
    u, v = np.array([0.6, -0.48, 0.64]), np.array([0.8, 0.36, -0.48])
    c = moved(size * u)
    turned = {"quaternion_xyzw": pose(moved([0, 0, 0], 0.3 * v))["quaternion_xyzw"]}
    about = {"type": "arc", "axis": v.tolist()}
    wide = {**about, "centre": (T0.translation + 0.1 * u).tolist(), "angle": 10.0 * size}
    through = (T0.translation + size * (0.5 * u + 0.3 * v)).tolist()
    teeth = {"length": 0.04, "height": 0.01}
    end = (np.array(START) + size * np.array([1.0, -1.0, 0.5, 0.3, -0.2, 1.0])).tolist()
    return {
        "line": [{"type": "line", "to": pose(c)}],
        "line that turns": [{"type": "line", "to": pose(moved([0, 0, 0], size * v))}],
        "line that turns and moves": [{"type": "line", "to": pose(moved(size * v, size * u))}],
        "line to a position": [{"type": "line", "to": pose(c, False)}],
        "position, then a turn": [
            {"type": "line", "to": pose(c, False)},
            {"type": "line", "to": pose(moved(2.0 * size * u, 0.3 * v))},
        ],
        "many lines": [{"type": "line", "to": near(size, k)} for k in range(6)],
        "spline": [{"type": "spline", "through": [pose(c)]}],
        "spline there and back": [{"type": "spline", "through": [pose(c), near(size, 1), HERE]}],
        "spline that begins so": [{"type": "spline", "through": [pose(c), FAR, FARTHER]}],
        "spline that ends so": [
            {"type": "spline", "through": [pose(c, False), FAR, HERE, near(size, 2)]}
        ],
        "joint values": [{"type": "joint", "q": end}],
        "joint to": [{"type": "joint", "to": pose(c)}],
        "arc through": [{"type": "arc", "via": through, "to": pose(c)}],
        "arc of a small angle": [{**wide, "orientation": "follow"}],
        "arc of a small angle that turns": [{**wide, "orientation": turned}],
        "arc of a small radius": [
            {**about, "centre": (T0.translation + size * u).tolist(), "angle": 2.0}
        ],
        "circle": _curve("circle", size, (0.02, 0.0), radius=0.02, orientation="follow"),
        "small circle": _curve("circle", 0.0, (1e-6, 0.0), radius=1e-6, angle=1e6 * size + 1e-6),
        "helix": _curve("helix", size, (0.02, 0.0), radius=0.02, rise=0.01, turns=1.0),
        "rose": _curve("rose", size, (0.02, 0.0), radius=0.02),
        "sinusoid": _curve(
            "sinusoid", size, (0.0, 0.0), length=0.03, amplitude=0.01, wavelength=0.02
        ),
        "sawtooth": _curve("sawtooth", size, (0.0, 0.0), teeth=2, fall=50.0 * size, **teeth),
        "trapezoid": _curve(
            "trapezoid", size, (0.0, 0.0), periods=2, ramp=0.5 - 50.0 * size, **teeth
        ),
    }


def request(path: Document, start: str, sampling: Document) -> Document:
    """A request that begins at the pose of the start, wherever the arm is."""
    path = {"approach": "joint", **path} if start == "joint" else path
    if "segments" in path and start != "given":
        path = {"begin": HERE, **path}
    return {
        "robot": "ur5",
        "start": "free" if start == "free" else START,
        "path": path,
        "ik": {"method": "lm"},
        "sampling": sampling,
    }
