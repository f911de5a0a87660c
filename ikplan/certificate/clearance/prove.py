"""Prove that a motion keeps bodies apart, at every instant of it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ikplan.certificate.clearance.chain import JointChain, chain_of, place_joints
from ikplan.certificate.clearance.curve import JointCurve
from ikplan.certificate.clearance.gjk import scratch
from ikplan.certificate.clearance.penetration import depth_at_most
from ikplan.certificate.clearance.report import Report
from ikplan.certificate.clearance.result import ClearanceResult, ClearanceViolation, joined
from ikplan.certificate.clearance.search import Curve, Findings, Settings, findings, search
from ikplan.certificate.clearance.shapes import PieceArrays, PiecePairs, piece_pairs, pieces_of
from ikplan.certificate.clearance.windows import is_there, windows_of
from ikplan.errors import InvalidRequest
from ikplan.robots.robot import Robot
from ikplan.scene.body import CollisionModel

__all__ = ["ClearanceProof", "prove_clearance"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]

_PARTS = 16
_RESOLUTION = 1e-5
_MOST = 400_000
_TOUCHING = 1e-9
"""Hulls this near to each other are taken to overlap [m]."""


class ClearanceProof:
    """The bodies of a robot and a scene, ready for proofs of many motions.

    Attributes:
        robot: The robot.
        model: The bodies.
    """

    def __init__(self, robot: Robot, model: CollisionModel) -> None:
        """Read a collision model.

        Args:
            robot: The robot; its tool is among the bodies.
            model: The bodies and pairs.

        Raises:
            InvalidRequest: The model is not one of this robot.
            InvalidRobot: The robot's joints are no chain.
        """
        self.robot = robot
        self.model = model
        self.chain: JointChain = chain_of(robot)
        self.pieces: PieceArrays = pieces_of(model, len(self.chain.slides) + 1)
        self.pairs: PiecePairs = piece_pairs(model, self.pieces)
        self._bodies: Ints = np.asarray(model.pairs, dtype=np.int64).reshape(-1, 2)
        obstacle = np.array([body.kind == "obstacle" for body in model.bodies], dtype=np.bool_)
        self._obstacle: NDArray[np.bool_] = np.asarray(obstacle[self._bodies].any(axis=1))

    def prove(
        self,
        curve: JointCurve,
        *,
        segment_times: Sequence[tuple[float, float]] | None = None,
        tolerance: float = 1e-3,
        resolution: float = _RESOLUTION,
    ) -> ClearanceResult:
        """Prove the model's clearance over a motion; see :func:`prove_clearance`."""
        if not (tolerance > 0.0 and resolution > 0.0):
            raise InvalidRequest(
                f"tolerance {tolerance!r} and resolution {resolution!r} must be above 0",
                field="tolerance",
                allowed="> 0 [m]",
            )
        controls = curve.serial(self.robot.coupling, self.robot.coupling_offset)
        arrays = Curve(controls, *_extremes(controls))
        settings = Settings(self.model.clearance, tolerance, resolution, _PARTS, _MOST)
        windows = windows_of(curve.duration, segment_times)
        direction, space = np.zeros((len(self.pairs.group), 3)), scratch()
        report = Report(self.model, self.pieces, self.pairs, self._obstacle, curve, tolerance)
        parts: list[Findings] = []
        known: dict[tuple[int, ...], tuple[Ints, Ints]] = {}
        passing = [
            k for k, body in enumerate(self.model.bodies)
            if body.first_segment is not None or body.last_segment is not None
        ]  # fmt: skip
        for window in windows:
            absent = tuple([k for k in passing if not is_there(self.model.bodies[k], window)])
            if absent not in known:
                known[absent] = self._active(absent)
            active, rows = known[absent]
            out = findings()
            begin, end = curve.window(window.begin, window.end)
            if len(active):
                search(self.chain, self.pieces, self.pairs, active, arrays, begin, end, settings,
                       direction, space, out)  # fmt: skip
            parts.append(out)
            report.add(window, out, rows)
        whole = joined(parts)
        document = report.document(whole)
        violation = None if document.proven else self._violation(curve, whole)
        return ClearanceResult(document, violation, int(whole.counts[0]), int(whole.counts[1]))

    def _active(self, absent: tuple[int, ...]) -> tuple[Ints, Ints]:
        """Pairs of pieces, and rows of the model's pairs, without those of absent bodies."""
        both = np.logical_not(np.asarray(np.isin(self._bodies, absent).any(axis=1)))
        return np.flatnonzero(both[self.pairs.pair]), np.flatnonzero(both)

    def _violation(self, curve: JointCurve, whole: Findings) -> ClearanceViolation:
        """The place nearest to contact, of the groups that are not proven."""
        asked = self.model.clearance
        least = np.minimum(whole.least, whole.found)
        open_groups = (least <= 0.0) | (least < asked) | (whole.undecided > 0)
        g = int(np.argmin(np.where(open_groups, whole.found, np.inf)))
        k, u = int(whole.pair[g]), float(whole.at[g])
        i, j = int(self.pairs.first[k]), int(self.pairs.second[k])
        a, b = (self.model.bodies[int(self.pieces.body[piece])].name for piece in (i, j))
        gap = float(whole.found[g])
        q = curve.at(u)
        depth = 0.0
        if gap <= 0.0:
            radii = float(self.pieces.radius[i] + self.pieces.radius[j])
            first, second = self._corners(q, i), self._corners(q, j)
            apart = float(np.linalg.norm(whole.points[g, 0] - whole.points[g, 1]))
            overlap = depth_at_most(first, second, radii) if apart <= _TOUCHING else radii - apart
            depth = max(overlap, 0.0)
        undecided = gap > max(self.model.clearance, 0.0)
        return ClearanceViolation(curve.time(u), (a, b), max(gap, 0.0), depth, q, undecided)

    def _corners(self, q: Array, piece: int) -> Array:
        """Corners of a piece in the base frame, shape (n, 3) [m]."""
        serial = self.robot.coupling @ q + self.robot.coupling_offset
        R, p = np.empty((len(serial) + 1, 3, 3)), np.empty((len(serial) + 1, 3))
        place_joints(self.chain, serial, R, p)
        begin, end = self.pieces.start[piece], self.pieces.start[piece + 1]
        carrier = self.pieces.carrier[piece]
        corners: Array = self.pieces.xyz[:, begin:end].T @ R[carrier].T + p[carrier]
        return corners


def _extremes(controls: Array) -> tuple[Array, Array]:
    """Least and greatest control values of each piece, shape (n, m) each."""
    c0, c1, c2, c3 = (controls[:, k] for k in range(4))
    low: Array = np.minimum(np.minimum(c0, c1), np.minimum(c2, c3))
    high: Array = np.maximum(np.maximum(c0, c1), np.maximum(c2, c3))
    return low, high


def prove_clearance(
    robot: Robot,
    model: CollisionModel,
    motion: JointCurve,
    *,
    segment_times: Sequence[tuple[float, float]] | None = None,
    tolerance: float = 1e-3,
    resolution: float = _RESOLUTION,
) -> ClearanceResult:
    """Prove that a motion keeps the bodies of a model apart at every instant.

    The motion is halved until, for every pair and interval, the distance at the middle less the
    most that the bodies can move against each other in the interval is enough.

    Args:
        robot: The robot.
        model: Bodies, pairs and the clearance asked for.
        motion: :meth:`JointCurve.of_motion` of a plan's polynomials, or
            :meth:`JointCurve.of_samples`.
        segment_times: When each segment begins and ends [s], counted as ``first_segment`` of
            bodies counts them, from 0; None: the motion is one, and every body is there.
        tolerance: Most between the nearest place found and the bound proven [m].
        resolution: A pair nearer to the clearance asked for than what moves in so small an
            interval is not decided, and counts as contact [m].

    Returns:
        The document, and where bodies are too near.

    Raises:
        InvalidRequest: The model, the times or the motion do not fit the robot.
        InvalidRobot: The robot's joints are no chain of joints of one axis.
    """
    return ClearanceProof(robot, model).prove(
        motion, segment_times=segment_times, tolerance=tolerance, resolution=resolution
    )
