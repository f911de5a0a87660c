"""Figures in one style."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

__all__ = ["boxes", "curves", "legend_below", "new_figure", "paths_3d"]

Array = NDArray[np.float64]

FLOOR = 1e-14
"""Smaller values are drawn as this on a logarithmic axis: they are rounding."""
COLOURS = [plt.get_cmap("tab20")(i) for i in (0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 1, 3, 5, 7, 9)]


def new_figure(
    width: float, height: float, columns: int = 1, rows: int = 1, *, same_y: bool = False
) -> tuple[Figure, list[Axes]]:
    """Return a figure of some inches with its axes, row by row."""
    figure, axes = plt.subplots(
        rows, columns, figsize=(width, height), layout="constrained", sharey=same_y
    )
    flat = list(np.atleast_1d(axes).ravel())
    for ax in flat:
        ax.grid(visible=True, alpha=0.3)
        ax.tick_params(labelsize=8)
    return figure, flat


def boxes(ax: Axes, data: Mapping[str, Array], label: str, *, log: bool = False) -> None:
    """Draw a box plot, one box a series."""
    values = [np.maximum(v, FLOOR) if log else v for v in data.values()]
    ax.boxplot(values, tick_labels=list(data), widths=0.6, flierprops={"markersize": 3})
    ax.set_ylabel(label, fontsize=9)
    plt.setp(ax.get_xticklabels(), rotation=35, ha="right", fontsize=8)
    if log:
        ax.set_yscale("log")


def curves(
    ax: Axes,
    data: Mapping[str, Array],
    x_label: str,
    y_label: str,
    *,
    log: bool = False,
    first: int = 0,
) -> None:
    """Draw curves over their index."""
    for i, (name, values) in enumerate(data.items()):
        x = np.arange(len(values)) + first
        style = "-" if i < len(COLOURS) // 2 else "--"
        ax.plot(x, values, style, color=COLOURS[i % len(COLOURS)], label=name, linewidth=1.3)
    ax.set_xlabel(x_label, fontsize=9)
    ax.set_ylabel(y_label, fontsize=9)
    if log:
        ax.set_yscale("log")
    ax.xaxis.set_major_locator(MaxNLocator(integer=True))


def legend_below(figure: Figure, ax: Axes) -> None:
    """Add one legend for all axes, of the curves of one, below them."""
    handles, labels = ax.get_legend_handles_labels()
    columns = min(len(labels), int(figure.get_figwidth() / 1.3))
    figure.legend(handles, labels, loc="outside lower center", ncols=columns, fontsize=8)


def paths_3d(
    panels: Sequence[tuple[str, Mapping[str, Array]]], width: float, height: float, unit: str
) -> Figure:
    """Draw 3D paths: in each panel the path asked for, as dots, and those followed."""
    figure = plt.figure(figsize=(width, height))
    # No layout of Matplotlib's leaves room for the label of z.
    figure.subplots_adjust(left=0.01, right=0.96, bottom=0.06, top=0.92, wspace=0.12)
    for i, (title, paths) in enumerate(panels):
        ax = figure.add_subplot(1, len(panels), i + 1, projection="3d")
        for j, (name, p) in enumerate(paths.items()):
            style = "k." if j == 0 else "-"
            colour = {} if j == 0 else {"color": COLOURS[(j - 1) % len(COLOURS)]}
            ax.plot(p[:, 0], p[:, 1], p[:, 2], style, label=name, markersize=4, **colour)
        ax.set_title(title, fontsize=9)
        ax.tick_params(labelsize=6)
        ax.set_box_aspect(None, zoom=0.85)
        ax.patch.set_visible(False)  # it would hide the label of z of the panel before
        # From here no path of the papers is seen from its edge.
        ax.view_init(elev=25.0, azim=-35.0)
        # One scale for all axes: what is asked for, and a margin.
        asked = next(iter(paths.values()))
        middle = 0.5 * (asked.max(axis=0) + asked.min(axis=0))
        reach = 0.6 * float(np.ptp(asked, axis=0).max())
        ax.set(
            xlim=(middle[0] - reach, middle[0] + reach),
            ylim=(middle[1] - reach, middle[1] + reach),
            zlim=(middle[2] - reach, middle[2] + reach),
        )
        ax.locator_params(nbins=4)
        for axis, letter in zip((ax.xaxis, ax.yaxis, ax.zaxis), "xyz", strict=True):
            axis.set_label_text(f"{letter} [{unit}]", fontsize=7)
        ax.legend(fontsize=7, loc="upper left")
    return figure
