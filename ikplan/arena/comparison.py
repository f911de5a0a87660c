"""A comparison as tables, figures and files."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.arena.compared_runs import ComparedRuns
from ikplan.arena.figures import draw_comparison
from ikplan.arena.save import save_comparison
from ikplan.arena.tables import comparison_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["Comparison"]


class Comparison(ComparedRuns):
    """The runs of several solvers on the same targets, with tables, figures and files."""

    def table(self) -> str:
        """Return the summary as Markdown, with the tests of each pair below it."""
        return comparison_table(self)

    def plot(self, axes: Any = None) -> Figure:
        """Draw the comparison: fixed budget, targets reached, expected evaluations, ranks.

        Args:
            axes: Four axes of Matplotlib; None: a new figure.

        Raises:
            InvalidRequest: Not four axes.
        """
        return draw_comparison(self, axes)

    def save(self, folder: str | Path) -> list[Path]:
        """Write ``rows.csv``, ``table.md``, ``comparison.png``, and files for COCO and IOHanalyzer.

        Args:
            folder: Made where it is missing.

        Returns:
            The files.

        Raises:
            OSError: One cannot be written.
        """
        return save_comparison(self, Path(folder))
