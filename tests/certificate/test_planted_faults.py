"""A fault in what the planner makes of a request is refused by the certificate.

Each fault is planted at run time, in a builder, a kernel or a target of the planner; the same
request without it is planned. Were the certificate to use the planner's code, it would see the
path through the same fault, and let it pass.
"""

from __future__ import annotations

import importlib
import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import ikplan
from ikplan import CertificateViolated
from ikplan.pipeline import motion_stages

from .requests import paths, request

Fault = tuple[str, str, str, Callable[[Any], Any]]


def _scaled(position: int, factor: float) -> Callable[[Any], Any]:
    """The function with one of its arguments scaled."""

    def plant(function: Any) -> Any:
        def faulty(*args: Any, **kwargs: Any) -> Any:
            changed = list(args)
            changed[position] = factor * changed[position]
            return function(*changed, **kwargs)

        return faulty

    return plant


def _after(change: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """The function with its result changed."""

    def plant(function: Any) -> Any:
        return lambda *args, **kwargs: change(function(*args, **kwargs))

    return plant


def _columns_moved(R: Any) -> Any:
    """The axes of a rotation with each other's names."""
    return np.ascontiguousarray(R[:, [1, 2, 0]])


def _bent(piece: Any) -> Any:
    """A line that swerves by a twentieth of its length."""
    if piece.turns or piece.length < 1e-3:
        return piece
    aside = np.cross(piece.t, [0.3, -0.5, 0.7])
    return replace(piece, n=aside / np.linalg.norm(aside), k=0.4 / piece.length, h=1.0)


def _mirrored_arc(function: Any) -> Any:
    def faulty(p0: Any, via: Any, p1: Any) -> Any:
        chord = (p1 - p0) / np.linalg.norm(p1 - p0)
        along = p0 + float((via - p0) @ chord) * chord
        return function(p0, along + 1.3 * (via - along), p1)

    return faulty


def _shaking(function: Any) -> Any:
    def faulty(stack: Any, piece: Any, s: Any, **options: Any) -> Any:
        motion = function(stack, piece, s, **options)
        return motion._replace(p=motion.p + 2e-4 * np.sin(30.0 * s)[:, None])

    return faulty


def _other_free_axis(freedom: Any) -> Any:
    return freedom._replace(axis=(freedom.axis + 1) % 3)


def _wider_box(freedom: Any) -> Any:
    return freedom._replace(box=1.5 * freedom.box + 0.003)


def _cone_of(factor: float) -> Callable[[Any], Any]:
    return lambda freedom: freedom._replace(cone=factor * freedom.cone)


def _aside(target: Any) -> Any:
    return target._replace(p=target.p + np.array([0.0, 3e-4, 0.0]))


def _twisted(target: Any) -> Any:
    c, s = math.cos(5e-3), math.sin(5e-3)
    return target._replace(R=target.R @ np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def _transposed(frame: Any) -> Any:
    R, origin = frame
    return R.T.copy(), origin


def _quintic(function: Any) -> Any:
    def faulty(begin: Any, end: Any) -> Any:
        return function(begin * np.array([[1.0], [1.4], [1.0]]), end)

    return faulty


def _reach(function: Any) -> Any:
    """A corner that is cut where half of its radius was asked for."""
    return lambda before, after, radius: function(before, after, 1.3 * radius)


def _tilted(axis: Any) -> Any:
    tilted = axis + 0.05 * np.array([0.6, -0.8, 0.0])
    return tilted / np.linalg.norm(tilted)


def _leaning(q: Any) -> Any:
    """Quaternions of which the second leans aside."""
    leant = q.copy()
    leant[1:2] += np.array([0.01, 0.0, 0.0, 0.0])
    return np.ascontiguousarray(leant / np.linalg.norm(leant, axis=1)[:, None])


def _changed(position: int, change: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """The class or function with one of its arguments changed."""

    def plant(function: Any) -> Any:
        def faulty(*args: Any) -> Any:
            return function(*args[:position], change(args[position]), *args[position + 1 :])

        return faulty

    return plant


def _curve(**changes: Callable[[Any], Any]) -> Callable[[Any], Any]:
    """Curves of a request with some of their fields changed."""

    def plant(function: Any) -> Any:
        def faulty(segment: Any, *args: Any) -> Any:
            update = {k: change(getattr(segment, k)) for k, change in changes.items()}
            return function(segment.model_copy(update=update), *args)

        return faulty

    return plant


def _clamped(_: Any) -> Any:
    """A spline that begins and ends at rest instead of without curvature."""
    return lambda x, y: CubicSpline(x, y, axis=0, bc_type="clamped")


FAULTS: dict[str, Fault] = {
    # Builders of segments.
    "a line swerves": ("line", "ikplan.path.build.builder", "line", _after(_bent)),
    "an arc is drawn twice as wide": (
        "arc about a centre",
        "ikplan.path.curves.arcs",
        "helix_about",
        _scaled(1, 2.0),
    ),
    "an arc misses its via": (
        "arc through a point",
        "ikplan.path.build.builder",
        "arc_through",
        _mirrored_arc,
    ),
    "an arc that follows turns too far": (
        "arc that follows",
        "ikplan.path.pieces.steady",
        "SteadyPiece.following",
        lambda f: lambda self, R0, axis: f(self, R0, 1.5 * axis),
    ),
    "a circle is too large": (
        "circle",
        "ikplan.path.build.builder",
        "curve_pieces",
        _curve(radius=lambda r: 1.02 * r),
    ),
    "a circle begins elsewhere": (
        "circle that follows",
        "ikplan.path.build.builder",
        "curve_pieces",
        _curve(phase=lambda a: a + 0.02),
    ),
    "a helix falls": (
        "helix",
        "ikplan.path.build.builder",
        "curve_pieces",
        _curve(rise=lambda rise: -rise),
    ),
    "a rose has other petals": (
        "rose",
        "ikplan.path.curves.named_curves",
        "RoseShape",
        _changed(3, lambda petals: petals + 2),
    ),
    "a rose turns the tool about another axis": (
        "rose that follows",
        "ikplan.path.pieces.curved",
        "HeadingTurning",
        _changed(3, _tilted),
    ),
    "a wave is too high": (
        "sinusoid",
        "ikplan.path.curves.named_curves",
        "SinusoidShape",
        _changed(3, lambda amplitude: 1.05 * amplitude),
    ),
    "teeth fall too steeply": (
        "sawtooth",
        "ikplan.path.build.builder",
        "curve_pieces",
        _curve(fall=lambda share: 0.5 * share),
    ),
    "flanks are too steep": (
        "trapezoid",
        "ikplan.path.build.builder",
        "curve_pieces",
        _curve(ramp=lambda share: 0.8 * share),
    ),
    "a spline has other ends": ("spline", "ikplan.path.curves.shapes", "NaturalSpline", _clamped),
    "a spline turns otherwise": (
        "spline",
        "ikplan.path.pieces.spline_turning",
        "NaturalSpline",
        _clamped,
    ),
    "a spline of waypoints has other ends": (
        "spline waypoints",
        "ikplan.path.curves.shapes",
        "NaturalSpline",
        _clamped,
    ),
    "a blend leaves its ball": ("blend", "ikplan.path.build.assembly", "blend_corner", _reach),
    "a blend has another shape": ("blend", "ikplan.path.pieces.blend", "QuinticShape", _quintic),
    "a blend turns otherwise": (
        "blend",
        "ikplan.path.pieces.blend",
        "BlendTurning",
        _changed(1, lambda rate: rate + np.array([0.0, 0.0, 0.2])),
    ),
    "the long way round is not taken": (
        "line, long way",
        "ikplan.path.build.builder",
        "shortest_turn",
        lambda f: lambda *args, **kwargs: f(*args, **{**kwargs, "turn_axis": None}),
    ),
    "a part without orientation is led elsewhere": (
        "led to an orientation",
        "ikplan.path.build.orientation_lead_in",
        "shortest_turn",
        _after(lambda turn: 0.5 * turn),
    ),
    "a curve turns too little to its end": (
        "curve with an end",
        "ikplan.path.build.builder",
        "shortest_turn",
        _after(lambda turn: 0.9 * turn),
    ),
    "joint values are others": (
        "joint values",
        "ikplan.planning.joint_planner",
        "check_start",
        _after(lambda q: q + 1e-3),
    ),
    # Kernels of the path.
    "pieces shake": ("line", "ikplan.path.tool_path", "motion_on", _shaking),
    "an even turning is too fast": (
        "rose with an end",
        "ikplan.path.pieces.curved",
        "SteadyTurning",
        _changed(2, lambda rate: 1.02 * rate),
    ),
    "quaternions are read backwards": (
        "line",
        "ikplan.path.rotation.so3",
        "matrix_rows",
        lambda f: lambda q: f(np.ascontiguousarray(q * np.array([-1.0, -1.0, -1.0, 1.0]))),
    ),
    "logarithms are too short": (
        "line",
        "ikplan.path.rotation.so3",
        "log_rows",
        _after(lambda v: 0.97 * v),
    ),
    "quaternions of matrices lean": (
        "spline",
        "ikplan.path.rotation.so3",
        "quaternion_rows",
        _after(_leaning),
    ),
    # Targets.
    "targets are beside the path": (
        "joint waypoints",
        "ikplan.planning.task_freedom",
        "pose_target",
        _after(_aside),
    ),
    "targets are twisted": (
        "joint pose",
        "ikplan.planning.task_freedom",
        "pose_target",
        _after(_twisted),
    ),
    "another axis is free": (
        "free about an axis",
        "ikplan.planning.tool_leg",
        "freedom_of",
        _after(_other_free_axis),
    ),
    "the cone is wider": (
        "cone",
        "ikplan.planning.tool_leg",
        "freedom_of",
        _after(_cone_of(1.5)),
    ),
    "the box is wider": ("box", "ikplan.planning.tool_leg", "freedom_of", _after(_wider_box)),
    # Composition of frames.
    "points of the path frame are not turned": (
        "line waypoints",
        "ikplan.path.build.path_frame",
        "PathFrame.point",
        lambda _: lambda self, position: self._p + np.array(position),
    ),
    "orientations of a path's waypoints are not turned": (
        "joint waypoints",
        "ikplan.path.build.path_frame",
        "PathFrame.poses",
        _after(lambda poses: [pose._replace(R=_columns_moved(pose.R)) for pose in poses]),
    ),
    "orientations of the path frame are not turned": (
        "line",
        "ikplan.path.build.path_frame",
        "PathFrame.rotation",
        _after(lambda R: R if R is None else _columns_moved(R)),
    ),
    "a curve's frame is turned the other way": (
        "sinusoid",
        "ikplan.path.build.path_frame",
        "PathFrame.frame",
        _after(_transposed),
    ),
    "directions of the path frame are turned back": (
        "arc about a centre",
        "ikplan.path.build.path_frame",
        "PathFrame.direction",
        _after(lambda v: v * np.array([1.0, -1.0, 1.0])),
    ),
}


@pytest.fixture(scope="module")
def documents() -> dict[str, Any]:
    return paths()


@pytest.mark.parametrize("name", sorted({fault[0] for fault in FAULTS.values()}))
def test_without_a_fault_the_request_is_planned(name: str, documents: dict[str, Any]) -> None:
    plan = ikplan.plan(request(documents[name]))
    deviation = plan.certificate.max_path_deviation
    assert deviation is None or deviation <= 1e-4
    # At a rounded corner the tool passes within the ball instead.
    allowed = 0.02 if name == "blend" else 1e-4
    assert (plan.waypoints.position_error <= allowed).all()


@pytest.mark.parametrize("name", FAULTS)
def test_a_planted_fault_is_refused(
    name: str, documents: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    path, module, place, plant = FAULTS[name]
    holder: Any = importlib.import_module(module)
    *owners, attribute = place.split(".")
    for owner in owners:
        holder = getattr(holder, owner)
    monkeypatch.setattr(holder, attribute, plant(getattr(holder, attribute)))
    # A faulty blend is not to be avoided by a stop at its corner.
    monkeypatch.setattr(motion_stages, "without_blends", lambda _: None)
    with pytest.raises(CertificateViolated) as caught:
        ikplan.plan(request(documents[path]))
    said = ("is missed by", "the path is left by", "are missed by")
    assert any(word in violation for violation in caught.value.violations for word in said)
