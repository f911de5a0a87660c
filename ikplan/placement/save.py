"""Maps of placements in files: CSV or Parquet with a row for each placement, and a figure."""

from __future__ import annotations

import csv
import io
import math
from pathlib import Path

import numpy as np

from ikplan.errors import InvalidRequest
from ikplan.placement.evaluation import PLANNED
from ikplan.placement.place import Placement

__all__ = ["check_map_file", "draw_placement", "save_placement"]

_SUFFIXES = (".parquet", ".csv")


def check_map_file(file: str | Path) -> None:
    """Refuse a file that a map cannot be written to, before it is made.

    Raises:
        InvalidRequest: The suffix is wrong, or pyarrow is not installed.
    """
    suffix = Path(file).suffix
    if suffix not in _SUFFIXES:
        raise InvalidRequest(
            f"--output {file}: name it with .parquet or .csv",
            field="output",
            allowed=list(_SUFFIXES),
        )
    if suffix == ".parquet":
        try:
            import pyarrow.parquet  # noqa: F401 - only whether it is there
        except ImportError as error:
            raise InvalidRequest(
                "--output: Parquet needs pyarrow: pip install 'ikplan[parquet]'", field="output"
            ) from error


def save_placement(found: Placement, file: str | Path) -> None:
    """Write every placement looked at: a row each, in the order of the searches.

    The columns are the names of what changes [m or rad], ``outcome``, ``value`` (empty or null
    without a plan) and ``reached``.

    Raises:
        InvalidRequest: The suffix is wrong, or pyarrow is not installed.
        OSError: The file cannot be written.
    """
    check_map_file(file)
    if Path(file).suffix == ".csv":
        text = io.StringIO(newline="")
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow([*found.names, "outcome", "value", "reached"])
        for row in found.rows:
            value = "" if math.isnan(row.value) else repr(row.value)
            writer.writerow([*map(repr, row.values), row.outcome, value, repr(row.reached)])
        Path(file).write_text(text.getvalue(), encoding="utf-8")
        return
    import pyarrow as pa
    import pyarrow.parquet as pq

    values = np.array([row.value for row in found.rows])
    columns: dict[str, object] = {
        name: pa.array(found.values[:, k]) for k, name in enumerate(found.names)
    }
    columns["outcome"] = pa.array([row.outcome for row in found.rows])
    columns["value"] = pa.array(values, mask=np.isnan(values))
    columns["reached"] = pa.array([row.reached for row in found.rows])
    pq.write_table(pa.table(columns), Path(file), compression="zstd")


def draw_placement(found: Placement, file: str | Path) -> None:
    """Draw the placements looked at, in each pair of neighbouring columns, and the search.

    Raises:
        InvalidRequest: No image can be written with that suffix.
        OSError: The file cannot be written.
    """
    from matplotlib.figure import Figure

    from ikplan.plans.figures.style import METADATA, check_image_suffix, style

    suffix = check_image_suffix(file)
    values = found.values
    planned = np.array([row.outcome == PLANNED for row in found.rows])
    worth = np.array([row.value for row in found.rows])
    pairs = [(k, k + 1) for k in range(len(found.names) - 1)] or [(0, 0)]
    with style():
        figure = Figure(figsize=(4.0 * (len(pairs) + 1), 3.6), layout="constrained")
        axes = figure.subplots(1, len(pairs) + 1, squeeze=False)[0]
        for axis, (a, b) in zip(axes, pairs, strict=False):
            axis.plot(*values[~planned][:, [a, b]].T, "x", color="0.6", markersize=4)
            drawn = axis.scatter(*values[planned][:, [a, b]].T, c=worth[planned], s=16)
            if planned.any():
                figure.colorbar(drawn, ax=axis)
            axis.set_xlabel(_label(found.names[a]))
            axis.set_ylabel(_label(found.names[b]))
        best = np.minimum.accumulate(np.where(planned, worth, np.inf))
        axes[-1].plot(np.arange(1, len(best) + 1), np.where(np.isinf(best), np.nan, best))
        axes[-1].set_xlabel("placements looked at")
        axes[-1].set_ylabel(f"least {found.aim}")
        figure.suptitle(f"{int(planned.sum())} of {len(planned)} placements have a plan")
        figure.savefig(file, dpi=120, metadata=METADATA[suffix])


def _label(name: str) -> str:
    return f"{name} [{'m' if name in 'xyz' else 'rad'}]"
