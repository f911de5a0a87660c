"""How far convex pieces reach beyond the mesh that they enclose."""

from __future__ import annotations

import coal
import numpy as np
from numpy.typing import NDArray

from ikplan.scene.hulls import distance_beyond, hull_of
from ikplan.scene.urdf_shapes import MeshGeometry

__all__ = ["Piece", "measured_excess"]

Array = NDArray[np.float64]
Piece = tuple[Array, float]
"""Points, shape (n, 3), and the radius about their hull [m]."""

SAMPLES = 4_000
"""Points on the surface of the pieces of a mesh."""
_AT_ONCE = 50


def measured_excess(pieces: list[Piece], mesh: MeshGeometry) -> float:
    """Return how far the union of pieces reaches beyond a mesh, at points of its surface [m].

    What is inside the mesh is no excess, as far as its surface winds around it; of one piece, the
    distance from the surface counts, from inside too.

    Args:
        pieces: The pieces, in the frame of the mesh.
        mesh: The mesh.
    """
    place = _surface(pieces)
    distance = _to_mesh(place, mesh)
    order = np.argsort(-distance, kind="stable")
    if len(pieces) == 1:
        return float(distance[order[0]])
    for first in range(0, len(order), _AT_ONCE):
        part = order[first : first + _AT_ONCE]
        outside = ~_is_inside(place[part], mesh.vertices[mesh.triangles])
        if outside.any():
            return float(distance[part[outside][0]])
    return 0.0


def _surface(pieces: list[Piece]) -> Array:
    """Points on the surface of the union of pieces, corners of their hulls among them."""
    rng = np.random.default_rng(0)
    points, owners = [], []
    for k, (corners, radius) in enumerate(pieces):
        hull = hull_of(corners)
        assert hull is not None
        facets = corners[hull.simplices]
        u, v = facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]
        areas = np.linalg.norm(np.cross(u, v), axis=1)
        chosen = rng.choice(len(facets), SAMPLES // len(pieces), p=areas / areas.sum())
        shares = rng.dirichlet(np.ones(3), len(chosen))
        normal = hull.equations[chosen, :3]
        surface = np.einsum("ni,nij->nj", shares, facets[chosen])
        points += [surface + radius * normal, corners[hull.vertices]]
        owners += [np.full(len(chosen) + len(hull.vertices), k)]
    place, owner = np.concatenate(points), np.concatenate(owners)
    for k, (corners, radius) in enumerate(pieces):
        hull = hull_of(corners)
        assert hull is not None
        inside = distance_beyond(place, hull) < radius - 1e-9
        keep = ~inside | (owner == k)
        place, owner = place[keep], owner[keep]
    return place


def _to_mesh(points: Array, mesh: MeshGeometry) -> Array:
    """Distance of points to the surface of a mesh [m]."""
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(mesh.triangles), len(mesh.vertices))
    model.addVertices(mesh.vertices)
    model.addTriangles(mesh.triangles.astype(np.int64))
    model.endModel()
    point, still = coal.Sphere(1e-9), coal.Transform3s()
    request, result = coal.DistanceRequest(), coal.DistanceResult()
    found = np.empty(len(points))
    for k, place in enumerate(points):
        result.clear()
        T = coal.Transform3s(np.eye(3), place)
        found[k] = coal.distance(model, still, point, T, request, result)
    return np.maximum(found, 0.0)


def _is_inside(points: Array, triangles: Array) -> NDArray[np.bool_]:
    """Whether a surface winds around points (Jacobson et al., 2013, generalised winding number)."""
    total = np.zeros(len(points))
    for first in range(0, len(triangles), 20_000):
        a, b, c = (triangles[None, first : first + 20_000, k] - points[:, None] for k in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=2) for x in (a, b, c))
        volume = np.einsum("nti,nti->nt", a, np.cross(b, c))
        below = (
            la * lb * lc
            + np.einsum("nti,nti->nt", a, b) * lc
            + np.einsum("nti,nti->nt", b, c) * la
            + np.einsum("nti,nti->nt", c, a) * lb
        )
        total += 2.0 * np.arctan2(volume, below).sum(axis=1)
    inside: NDArray[np.bool_] = np.abs(total) > 2.0 * np.pi
    return inside
