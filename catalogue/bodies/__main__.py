"""Write the shapes of robots whose links have meshes: ``python -m catalogue.bodies ur5``.

Each link gets the convex hull of each of its meshes; where that reaches more than 13 mm beyond the
mesh, the mesh is split. Pieces are thinned to few points and enlarged by a radius that brings back
inside what was left out.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

import numpy as np
import orjson
from numpy.typing import NDArray

from catalogue.bodies.measure import Piece, measured_excess
from catalogue.bodies.sources import SOURCES, meshes_of
from catalogue.bodies.split import Limits, Search, split_mesh
from ikplan.scene.hulls import enclosing_points
from ikplan.scene.urdf_shapes import MeshGeometry

Array = NDArray[np.float64]

FINE = Search(grid=60_000, planes=16, corners=0.004, diagonals=True)
EXACT = Limits(points=400)
LIMITS = {
    # Their stands are wide and hollow.
    "baxter_left": Limits(most=16),
    "baxter_right": Limits(most=16),
    # The hollow of these bases is round.
    "kinova_j2s6s200/j2s6s200_link_base": Limits(most=8),
    "ur3/base_link": Limits(most=10),
    # Its hulls refuse next to nothing for nothing: fewer points are enough.
    "panda": Limits(points=128, tolerance=5e-4),
    # These links pass others closely.
    "ur3/shoulder_link": EXACT,
    "ur3/wrist_1_link": EXACT,
    "ur3/wrist_2_link": EXACT,
    "ur5": Limits(search=FINE),
}
"""Of robots and links that need others than the usual ones."""
DIGITS = 6
ROUNDING = 2e-6
"""Added to each radius for the rounding of the points [m]."""


def main() -> None:
    """Write the file of each robot named."""
    parser = argparse.ArgumentParser(prog="catalogue.bodies", description=__doc__)
    parser.add_argument("robots", nargs="+", choices=sorted(SOURCES))
    parser.add_argument("--out", type=Path, default=Path(__file__).parents[2] / "robots")
    options = parser.parse_args()
    for name in options.robots:
        folder = options.out / name
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "collision.json").write_text(_text(_document(name)))


def _text(document: dict[str, Any]) -> str:
    """A document as JSON, a piece a line."""
    text = orjson.dumps(document).decode()
    return text.replace('{"points"', '\n{"points"').replace('"},"links"', '"},\n"links"') + "\n"


def _document(name: str) -> dict[str, Any]:
    links: dict[str, list[MeshGeometry]] = {}
    for mesh in meshes_of(name):
        links.setdefault(mesh.link, []).append(mesh)
    print(name)
    source, usual = SOURCES[name], LIMITS.get(name, Limits())
    meshes = f"the meshes of {source.package}" + (f", of {source.of}" if source.of else "")
    return {
        "source": f"convex hulls of {meshes}",
        "licence": f"{source.licence}, as {source.where} says",
        "method": "python -m catalogue.bodies",
        "links": {
            link: _link(link, found, LIMITS.get(f"{name}/{link}", usual), meshes)
            for link, found in links.items()
        },
    }


def _link(link: str, meshes: list[MeshGeometry], limits: Limits, of: str) -> dict[str, Any]:
    pieces: list[Piece] = []
    excess, split = 0.0, False
    for mesh in meshes:
        made = [_thinned(mesh.vertices, limits.points, limits.tolerance)]
        reach = of_hull = measured_excess(made, mesh)
        if of_hull > limits.beyond and limits.most > 1:
            most = 5 * limits.points // 6
            parts = [_thinned(part, most, limits.tolerance) for part in split_mesh(mesh, limits)]
            beyond = measured_excess(parts, mesh)
            if beyond < of_hull:
                made, reach = parts, beyond
        split |= len(made) > 1
        print(
            f"  {link}: {len(made)} piece(s), {sum(len(p[0]) for p in made)} points, "
            f"excess {1e3 * reach:.1f} mm, of the hull {1e3 * of_hull:.1f} mm",
            flush=True,
        )
        pieces += made
        excess = max(excess, reach)
    entry: dict[str, Any] = {"excess": round(excess + 5e-5, 4), "pieces": _entries(pieces)}
    if split:
        entry["source"] = f"convex pieces of {of}"
    return entry


def _entries(pieces: list[Piece]) -> list[dict[str, Any]]:
    return [
        {"points": points.round(DIGITS).tolist(), "radius": round(radius + 5e-7, 6)}
        for points, radius in pieces
    ]


def _thinned(points: Array, most: int, tolerance: float) -> Piece:
    kept, radius, _ = enclosing_points(points, most, tolerance)
    return kept, radius + ROUNDING


if __name__ == "__main__":
    main()
