"""Make the files of shapes of robots whose URDF has meshes: convex pieces that enclose them.

    python robots/make_collision.py ur5 [--out robots]

Each link gets the convex hull of each of its meshes; where that reaches more than 15 mm beyond the
mesh, the mesh is split by CoACD (Wei et al., ACM Transactions on Graphics 41(4), 2022; PyPI:
coacd, needed here only). What CoACD returns is not trusted to cover the mesh: the mesh is cut into
small triangles, each is given to the piece nearest to it, and a piece becomes the hull of itself
and of its triangles. So every triangle lies in one piece. Pieces are thinned to few points and
enlarged by a radius that brings back inside what was left out.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

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
THRESHOLD = 0.05
"""CoACD's measure of concavity at which it stops."""
MOST_PIECES = 6
HULL_POINTS = 128
PIECE_POINTS = 64
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
    parser.add_argument("--hulls", action="store_true", help="hulls only, excess not measured")
    arguments = parser.parse_args()
    for name in arguments.robots:
        file = arguments.out / name / "collision.json"
        file.write_text(_text(make(name, hulls=arguments.hulls)))


def _text(document: dict[str, Any]) -> str:
    """A document as JSON, a piece a line."""
    text = orjson.dumps(document).decode()
    return text.replace('{"points"', '\n{"points"').replace('"},"links"', '"},\n"links"') + "\n"


def make(name: str, *, hulls: bool = False) -> dict[str, Any]:
    """Return the file of a robot; with ``hulls``, nothing is split and no excess measured."""
    source = load_robot(name).description.shapes
    links: dict[str, list[MeshGeometry]] = {}
    for mesh in link_meshes(source.urdf, source.folder, name):
        links.setdefault(mesh.link, []).append(mesh)
    return {
        "source": "convex hulls of the meshes of example-robot-data 6.0.0",
        "licence": LICENCES[name],
        "method": "robots/make_collision.py",
        "links": {link: _link(link, meshes, hulls) for link, meshes in links.items()},
    }


def _link(link: str, meshes: list[MeshGeometry], hulls: bool) -> dict[str, Any]:
    if hulls:
        made = [_thinned(mesh.vertices, HULL_POINTS) for mesh in meshes]
        source = "convex hulls of the meshes of example-robot-data 6.0.0, excess not measured"
        return {"source": source, "pieces": _entries(made)}
    pieces: list[Piece] = []
    excess, split = 0.0, 0
    for mesh in meshes:
        made = [_thinned(mesh.vertices, HULL_POINTS)]
        reach = hull_reach = _excess(made, mesh)
        if reach > SPLIT_BEYOND:
            parts = [_thinned(part, PIECE_POINTS) for part in _split(mesh)]
            reach = _excess(parts, mesh)
            made, split = parts, split + 1
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
        entry["source"] = (
            "convex pieces, found with CoACD, of the meshes of example-robot-data 6.0.0"
        )
    return entry


def _entries(pieces: list[Piece]) -> list[dict[str, Any]]:
    return [
        {"points": points.round(DIGITS).tolist(), "radius": round(radius + 5e-7, 6)}
        for points, radius in pieces
    ]


def _thinned(points: Array, most: int) -> Piece:
    kept, radius, _ = enclosing_points(points, most, TOLERANCE)
    return kept, radius + ROUNDING


def _split(mesh: MeshGeometry) -> list[Array]:
    """Points of convex pieces that cover every triangle of a mesh."""
    import coacd

    coacd.set_log_level("error")
    parts = coacd.run_coacd(
        coacd.Mesh(mesh.vertices, mesh.triangles),
        threshold=THRESHOLD,
        max_convex_hull=MOST_PIECES,
        seed=0,
    )
    hulls = [hull_of(np.array(vertices)) for vertices, _ in parts]
    triangles = _cut(mesh.vertices[mesh.triangles])
    corners = triangles.reshape(-1, 3)
    beyond = [distance_beyond(corners, hull).reshape(-1, 3).max(axis=1) for hull in hulls]
    owner = np.argmin(beyond, axis=0)
    return [
        np.concatenate([hull.points[hull.vertices], triangles[owner == k].reshape(-1, 3)])
        for k, hull in enumerate(hulls)
    ]


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
