"""Make the files of shapes of robots whose URDF has meshes: convex pieces that enclose them.

    python robots/make_collision.py ur5 [--out robots]

Each link gets the convex hull of each of its meshes; where that reaches more than 15 mm beyond the
mesh, the mesh is split. It is cut into small triangles, and the part that gains most is divided at
the plane across an axis of the link that leaves the least volume of both hulls, over and over.
Every triangle lies in one part, and so in its hull. Pieces are thinned to few points and enlarged
by a radius that brings back inside what was left out.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any, NamedTuple

import coal
import numpy as np
import orjson
from numpy.typing import NDArray

from ikplan.robots import load_robot
from ikplan.scene.hulls import distance_beyond, enclosing_points, hull_of
from ikplan.scene.urdf_shapes import MeshGeometry, link_meshes

Array = NDArray[np.float64]

SPLIT_BEYOND = 0.015
"""Excess of a hull from which on a mesh is split [m]."""
MOST_PIECES = 6
"""Of a mesh, unless --pieces says so."""
GAIN = 0.005
"""Least share of a mesh's hull that a further division takes away, unless --gain says so."""
PLANES = 16
"""Places at which a part is tried to be divided across each axis."""
GRID = 0.003
"""About the distance of the triangles that planes are chosen by [m]."""
HULL_POINTS = 128
PIECE_POINTS = 96
TOLERANCE = 5e-4
EDGE = 0.005
"""Longest edge of the triangles that are given to pieces [m]."""
DIGITS = 6
ROUNDING = 2e-6
"""Added to each radius for the rounding of the points [m]."""
SAMPLES = 600
"""Points on the surface of a link's pieces at which its excess is measured."""
LICENCES = {
    "baxter_left": "BSD-3-Clause, as baxter_description/LICENSE says",
    "baxter_right": "BSD-3-Clause, as baxter_description/LICENSE says",
    "z1": "MPL-2.0, as z1_description/README.md says",
    "kinova_j2s6s200": "BSD, as kinova_description/README.md says",
    "panda": "Apache-2.0, as panda_description/LICENSE says",
    "so101": "Apache-2.0, as so_arm_description/README.md says",
    "ur3": "BSD, as ur_description/README.md says",
    "ur5": "BSD, as ur_description/README.md says",
    "ur10": "BSD, as ur_description/README.md says",
    "xarm7": "BSD-3-Clause, as xarm_description/README.md says",
}
Piece = tuple[Array, float]


def main() -> None:
    """Write the file of each robot named."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("robots", nargs="+", choices=sorted(LICENCES))
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--hulls", action="store_true", help="hulls only: no mesh is split")
    parser.add_argument("--pieces", type=int, default=MOST_PIECES, help="most pieces of a mesh")
    parser.add_argument("--gain", type=float, default=GAIN, help="least share that pays a piece")
    arguments = parser.parse_args()
    limits = Limits(1 if arguments.hulls else arguments.pieces, arguments.gain)
    for name in arguments.robots:
        file = arguments.out / name / "collision.json"
        file.write_text(_text(make(name, limits)))


def _text(document: dict[str, Any]) -> str:
    """A document as JSON, a piece a line."""
    text = orjson.dumps(document).decode()
    return text.replace('{"points"', '\n{"points"').replace('"},"links"', '"},\n"links"') + "\n"


class Limits(NamedTuple):
    """How far meshes are split.

    Attributes:
        most: Most pieces of a mesh; 1: none is split.
        gain: Least share of a mesh's hull that a further division takes away.
    """

    most: int
    gain: float


def make(name: str, limits: Limits) -> dict[str, Any]:
    """Return the file of a robot."""
    source = load_robot(name).description.shapes
    links: dict[str, list[MeshGeometry]] = {}
    for mesh in link_meshes(source.urdf, source.folder, name):
        links.setdefault(mesh.link, []).append(mesh)
    return {
        "source": "convex hulls of the meshes of example-robot-data 6.0.0",
        "licence": LICENCES[name],
        "method": "robots/make_collision.py",
        "links": {link: _link(link, meshes, limits) for link, meshes in links.items()},
    }


def _link(link: str, meshes: list[MeshGeometry], limits: Limits) -> dict[str, Any]:
    pieces: list[Piece] = []
    excess, split = 0.0, 0
    for mesh in meshes:
        made = [_thinned(mesh.vertices, HULL_POINTS)]
        reach = hull_reach = _excess(made, mesh)
        if reach > SPLIT_BEYOND and limits.most > 1:
            parts = [_thinned(part, PIECE_POINTS) for part in _split(mesh, limits)]
            beyond = _excess(parts, mesh)
            if beyond < reach:
                made, reach = parts, beyond
        split += len(made) > 1
        print(
            f"{link}: {len(made)} piece(s), {sum(len(p[0]) for p in made)} points, "
            f"excess {1e3 * reach:.1f} mm, of the hull {1e3 * hull_reach:.1f} mm",
            flush=True,
        )
        pieces += made
        excess = max(excess, reach)
    entry: dict[str, Any] = {
        "excess": round(excess + 5e-5, 4),
        "pieces": _entries(pieces),
    }
    if split:
        entry["source"] = "convex pieces of the meshes of example-robot-data 6.0.0"
    return entry


def _entries(pieces: list[Piece]) -> list[dict[str, Any]]:
    return [
        {"points": points.round(DIGITS).tolist(), "radius": round(radius + 5e-7, 6)}
        for points, radius in pieces
    ]


def _thinned(points: Array, most: int) -> Piece:
    kept, radius, _ = enclosing_points(points, most, TOLERANCE)
    return kept, radius + ROUNDING


def _split(mesh: MeshGeometry, limits: Limits) -> list[Array]:
    """Points of parts of a mesh, each of its triangles in one."""
    parts = [_cut(mesh.vertices[mesh.triangles])]
    whole = _volume(parts[0])
    divided = [_divided(parts[0])]
    while len(parts) < limits.most:
        k = max(range(len(parts)), key=lambda k: divided[k][0])
        gain, halves = divided[k]
        if gain < limits.gain * whole:
            break
        parts[k : k + 1] = halves
        divided[k : k + 1] = [_divided(half) for half in halves]
    return [part.reshape(-1, 3) for part in parts]


def _divided(triangles: Array) -> tuple[float, list[Array]]:
    """Volume that the best division takes off the hull of a part [m^3], and both halves."""
    middle = triangles.mean(axis=1)
    _, some = np.unique(np.round(middle / GRID).astype(np.int64), axis=0, return_index=True)
    few, centre = triangles[some], middle[some]
    best, plane, whole = 0.0, (0, np.inf), _volume(few)
    for axis in range(3):
        low, high = middle[:, axis].min(), middle[:, axis].max()
        for share in np.arange(1, PLANES) / PLANES:
            place = float(low + share * (high - low))
            below = centre[:, axis] < place
            gain = whole - _volume(few[below]) - _volume(few[~below])
            if gain > best:
                best, plane = gain, (axis, place)
    below = middle[:, plane[0]] < plane[1]
    return best, [triangles[below], triangles[~below]]


def _volume(triangles: Array) -> float:
    """Volume of the hull of triangles [m^3]."""
    hull = hull_of(triangles.reshape(-1, 3))
    return 0.0 if hull is None else float(hull.volume)


def _cut(triangles: Array) -> Array:
    """Halve triangles at their longest edges until no edge is longer than EDGE."""
    done = []
    while len(triangles):
        edges = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=2)
        long = edges.max(axis=1) > EDGE
        done.append(triangles[~long])
        turn = edges[long].argmax(axis=1)
        rows = np.arange(len(turn))
        a, b, c = (triangles[long][rows, (turn + k) % 3] for k in range(3))
        middle = 0.5 * (a + b)
        halves = [np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)]
        triangles = np.concatenate(halves)
    return np.concatenate(done)


def _excess(pieces: list[Piece], mesh: MeshGeometry) -> float:
    """How far the union of pieces reaches beyond a mesh, at points of its surface [m]."""
    rng = np.random.default_rng(0)
    points, owners = [], []
    for k, (corners, radius) in enumerate(pieces):
        hull = hull_of(corners)
        facets = corners[hull.simplices]
        u, v = facets[:, 1] - facets[:, 0], facets[:, 2] - facets[:, 0]
        areas = np.linalg.norm(np.cross(u, v), axis=1)
        chosen = rng.choice(len(facets), SAMPLES // len(pieces), p=areas / areas.sum())
        shares = rng.dirichlet(np.ones(3), len(chosen))
        normal = hull.equations[chosen, :3]
        surface = np.einsum("ni,nij->nj", shares, facets[chosen])
        points += [surface + radius * normal, corners[hull.vertices[::4]]]
        owners += [np.full(len(chosen) + len(hull.vertices[::4]), k)]
    place, owner = np.concatenate(points), np.concatenate(owners)
    for k, (corners, radius) in enumerate(pieces):
        inside = distance_beyond(place, hull_of(corners)) < radius - 1e-9
        keep = ~inside | (owner == k)
        place, owner = place[keep], owner[keep]
    distance = _to_mesh(place, mesh)
    order = np.argsort(-distance)
    if len(pieces) == 1:
        return float(distance[order[0]])
    for first in range(0, len(order), 50):
        part = order[first : first + 50]
        outside = ~_is_inside(place[part], mesh.vertices[mesh.triangles])
        if outside.any():
            return float(distance[part[outside][0]])
    return 0.0


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


if __name__ == "__main__":
    main()
