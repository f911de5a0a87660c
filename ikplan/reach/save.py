"""Reach maps in files: Parquet with a row for each pose, and a figure."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest
from ikplan.path.rotation.so3_kernels import quaternion_rows
from ikplan.reach.path_reach import PathReach
from ikplan.reach.reach_map import ReachMap

__all__ = ["check_files", "draw_reach_map", "save_path_reach", "save_reach_map"]


def check_files(output: str | Path | None, plot: str | Path | None) -> None:
    """Refuse files that a map cannot be written to, before it is made.

    Args:
        output: The table; None: do not write it.
        plot: The figure; None: do not write it.

    Raises:
        InvalidRequest: A suffix is wrong, or a package is not installed.
    """
    if output is not None:
        if Path(output).suffix != ".parquet":
            raise InvalidRequest(
                f"--output {output}: name it with .parquet", field="output", allowed=[".parquet"]
            )
        try:
            import pyarrow.parquet  # noqa: F401 - only whether it is there
        except ImportError as error:
            raise InvalidRequest(
                "--output: Parquet needs pyarrow: pip install 'ikplan[parquet]'", field="output"
            ) from error
    if plot is not None:
        from ikplan.plans.figures.style import check_image_suffix

        check_image_suffix(plot)


def save_reach_map(found: ReachMap, file: str | Path) -> None:
    """Write a reach map as Parquet: a row for each pose, positions slowest.

    The columns are x, y, z [m], qx, qy, qz, qw, reached, in_contact, manipulability, clearance [m]
    (null where contact is not checked) and q, a list [rad or m]; null where a pose is not reached.

    Raises:
        InvalidRequest: The file is no ``.parquet``, or pyarrow is not installed.
        OSError: The file cannot be written.
    """
    check_files(file, None)
    import pyarrow as pa
    import pyarrow.parquet as pq

    m, n = found.reached.shape
    position = np.repeat(found.positions, n, axis=0)
    turn = np.tile(quaternion_rows(found.rotations), (m, 1))
    reached = found.reached.ravel()
    missing = ~reached
    columns: dict[str, object] = {
        name: pa.array(position[:, k]) for k, name in enumerate(("x", "y", "z"))
    }
    columns |= {name: pa.array(turn[:, k]) for k, name in enumerate(("qx", "qy", "qz", "qw"))}
    columns["reached"] = pa.array(reached)
    columns["in_contact"] = pa.array(found.in_contact.ravel())
    columns["manipulability"] = pa.array(found.manipulability.ravel(), mask=missing)
    gap = np.full(m * n, np.nan) if found.clearance is None else found.clearance.ravel()
    columns["clearance"] = pa.array(gap, mask=missing | np.isnan(gap))
    dof = found.q.shape[-1]
    values = pa.array(found.q.reshape(-1))
    columns["q"] = pa.FixedSizeListArray.from_arrays(values, dof, mask=pa.array(missing))
    pq.write_table(pa.table(columns), Path(file), compression="zstd")


def save_path_reach(found: PathReach, file: str | Path) -> None:
    """Write how much of a path is reached as Parquet: a row for each shift of it.

    The columns are x, y, z [m], reached and in_contact (shares of the poses along the path) and
    manipulability, the least along it (null where not all are reached).

    Raises:
        InvalidRequest: The file is no ``.parquet``, or pyarrow is not installed.
        OSError: The file cannot be written.
    """
    check_files(file, None)
    import pyarrow as pa
    import pyarrow.parquet as pq

    whole = found.reached.all(axis=1)
    least = np.where(np.isnan(found.manipulability), np.inf, found.manipulability).min(axis=1)
    columns: dict[str, object] = {
        name: pa.array(found.positions[:, k]) for k, name in enumerate(("x", "y", "z"))
    }
    columns["reached"] = pa.array(found.share)
    columns["in_contact"] = pa.array(found.in_contact.mean(axis=1))
    columns["manipulability"] = pa.array(least, mask=~whole)
    pq.write_table(pa.table(columns), Path(file), compression="zstd")


def draw_reach_map(found: ReachMap | PathReach, file: str | Path) -> None:
    """Draw the reached share and the best manipulability, seen from above and from the side.

    Raises:
        InvalidRequest: No image can be written with that suffix.
        OSError: The file cannot be written.
    """
    from matplotlib.figure import Figure

    from ikplan.plans.figures.style import METADATA, check_image_suffix, style

    suffix = check_image_suffix(file)
    with np.errstate(invalid="ignore"):
        best = np.where(found.reached.any(axis=1), _largest(found.manipulability), 0.0)
    with style():
        figure = Figure(figsize=(9.0, 7.5), layout="constrained")
        axes = figure.subplots(2, 2)
        columns = (
            ("share reached", found.share, 1.0),
            ("manipulability", best, None),
        )
        views = (("from above", 0, 1, "x [m]", "y [m]"), ("from the side", 0, 2, "x [m]", "z [m]"))
        for row, (view, a, b, x_label, y_label) in enumerate(views):
            for column, (what, values, most) in enumerate(columns):
                axis = axes[row, column]
                points, seen = _largest_seen(found.positions[:, [a, b]], values)
                drawn = axis.scatter(*points.T, c=seen, vmin=0.0, vmax=most, s=30, marker="s")
                figure.colorbar(drawn, ax=axis)
                axis.set_aspect("equal")
                axis.set_title(f"{what}, {view}")
                axis.set_xlabel(x_label)
                axis.set_ylabel(y_label)
        reached = f"{int(found.reached.sum()):,} of {found.reached.size:,} poses reached"
        figure.suptitle(f"{found.robot}: {reached}; largest values along the line of sight")
        figure.savefig(file, dpi=120, metadata=METADATA[suffix])


def _largest(values: Array) -> Array:
    """The largest number of each row, 0 where all are NaN."""
    return np.asarray(np.where(np.isnan(values), 0.0, values).max(axis=1))


def _largest_seen(points: Array, values: Array) -> tuple[Array, Array]:
    """Of points that fall on each other, one, and the largest of their values."""
    rounded = np.round(points, 9)
    unique, inverse = np.unique(rounded, axis=0, return_inverse=True)
    seen = np.zeros(len(unique))
    np.maximum.at(seen, inverse.ravel(), values)
    return unique, seen
