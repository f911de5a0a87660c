"""The distance kernel against coal, on random pairs of convex pieces."""

from __future__ import annotations

import time
from dataclasses import dataclass

import coal
import numba
import numpy as np
from numpy.typing import NDArray

from benchmarks.collision.drawing import box, draw_hull, rotation
from benchmarks.collision.oracle import coal_shape
from ikplan.certificate.clearance.gjk import Scratch, piece_distance, scratch
from ikplan.scene.body import ConvexPiece

__all__ = ["QueryStudy", "compare", "draw_pieces", "kernel_distances"]

Array = NDArray[np.float64]
Ints = NDArray[np.int64]


def _batch(
    xyz: Array, start: Ints, pairs: Ints, R: Array, p: Array, space: Scratch, found: Array
) -> None:
    """Query every pair from the direction of the centres, the first piece at the origin."""
    pose, origin, v = np.zeros((2, 3, 3)), np.zeros((2, 3)), np.zeros(3)
    for r in range(3):
        pose[0, r, r] = 1.0
    for n in range(pairs.shape[0]):
        pose[1] = R[n]
        origin[1] = p[n]
        v[:] = -p[n]
        found[n, 0], found[n, 1] = piece_distance(
            xyz, start, pairs[n, 0], pairs[n, 1], pose, origin, 0, 1, np.inf, -1.0, v, space
        )


_compiled_batch = numba.njit(_batch)


def draw_pieces(rng: np.random.Generator, count: int) -> list[ConvexPiece]:
    """Spheres, capsules, boxes (thin plates too) and hulls, some with a radius around them."""
    drawn = []
    for n in range(count):
        if n % 4 == 0:
            drawn.append(ConvexPiece(np.zeros((1, 3)), float(rng.uniform(0.02, 0.3))))
        elif n % 4 == 1:
            end = np.array([0.0, 0.0, float(rng.uniform(0.01, 0.4))])
            drawn.append(ConvexPiece(np.stack([-end, end]), float(rng.uniform(0.01, 0.1))))
        elif n % 4 == 2:
            edges = np.exp(rng.uniform(np.log(0.001), np.log(0.8), 3))
            drawn.append(box(np.zeros(3), edges))
        else:
            drawn.append(draw_hull(rng, 0.3, float(rng.choice([0.0, 0.02]))))
    return drawn


def kernel_distances(pieces: list[ConvexPiece], pairs: Ints, R: Array, p: Array) -> Array:
    """Return lower and upper bounds with the radii taken off, shape (n, 2) [m]."""
    xyz = np.ascontiguousarray(np.concatenate([piece.points for piece in pieces]).T)
    start = np.cumsum([0, *(len(piece.points) for piece in pieces)]).astype(np.int64)
    found = np.zeros((len(pairs), 2))
    _compiled_batch(xyz, start, pairs, R, p, scratch(), found)
    radius = np.array([piece.radius for piece in pieces])
    return np.asarray(found - radius[pairs].sum(axis=1)[:, None])


@dataclass(frozen=True)
class QueryStudy:
    """What the comparison found.

    Attributes:
        queries: How many pairs.
        touching: How many touch by coal.
        missed: How many of these the kernel has a positive lower bound for, by over 5 um.
        above: Largest lower bound less coal's distance, of the others [m].
        below: Largest coal distance less the upper bound [m].
        gap: Largest upper less lower bound of separated hulls [m].
        kernel_us: Time of a query [us].
        coal_us: Of coal's, its call from Python included [us].
    """

    queries: int
    touching: int
    missed: int
    above: float
    below: float
    gap: float
    kernel_us: float
    coal_us: float


def compare(count: int, seed: int = 0) -> QueryStudy:
    """Compare the kernel with coal on random pairs at distances of every order of magnitude."""
    rng = np.random.default_rng(seed)
    pieces = draw_pieces(rng, 64)
    pairs = rng.integers(0, len(pieces), (count, 2))
    R = np.stack([rotation(rng) for _ in range(count)])
    direction = rng.standard_normal((count, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    p = direction * rng.uniform(0.0, 1.0, (count, 1))
    kernel_distances(pieces, pairs[:1], R[:1], p[:1])
    begin = time.process_time()
    found = kernel_distances(pieces, pairs, R, p)
    kernel_s = time.process_time() - begin
    shapes = [coal_shape(piece) for piece in pieces]
    request, distance = coal.DistanceRequest(), np.zeros(count)
    begin = time.process_time()
    for n, (i, j) in enumerate(pairs.tolist()):
        result = coal.DistanceResult()
        (a, Ta), (b, Tb) = shapes[i], shapes[j]
        Tb = coal.Transform3s(R[n] @ Tb.rotation, R[n] @ Tb.translation + p[n])
        distance[n] = coal.distance(
            a, coal.Transform3s(Ta.rotation, Ta.translation), b, Tb, request, result
        )
    coal_s = time.process_time() - begin
    touching = distance <= 0.0
    apart = ~touching
    hulls = found[apart & (found[:, 0] > 0.0)]
    return QueryStudy(
        count,
        int(touching.sum()),
        int((found[touching, 0] > 5e-6).sum()),
        float((found[apart, 0] - distance[apart]).max()),
        float((distance[apart] - found[apart, 1]).max()),
        float((hulls[:, 1] - hulls[:, 0]).max()),
        1e6 * kernel_s / count,
        1e6 * coal_s / count,
    )
