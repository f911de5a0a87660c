"""From cells to numbers, each fault with its line and column."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ikplan.points.columns import Column
from ikplan.points.table import Row, Table, fault, is_number

__all__ = ["Values"]

_SHOWN = 100
"""Characters of a cell that a message shows."""


class Values:
    """The numbers of a table.

    Args:
        table: The table.
        columns: Its columns.

    Raises:
        InvalidRequest: A row has another number of cells than there are columns, or decimals are
            written with points and with commas.
    """

    def __init__(self, table: Table, columns: Sequence[Column]) -> None:
        self.columns = list(columns)
        self.rows = table.rows
        for row in self.rows:
            if len(row.cells) != len(columns):
                hint = ""
                if table.separator == "," and len(row.cells) == 2 * len(columns):
                    hint = ": decimal commas need another separator than the comma"
                raise fault(row, f"{len(row.cells)} values for {len(columns)} columns{hint}")
        self._refuse_mixed_decimals()

    def _refuse_mixed_decimals(self) -> None:
        """1,234 beside 5.6 may be a thousand and more."""
        found: dict[str, tuple[Row, str]] = {}
        for row in self.rows:
            for column, cell in zip(self.columns, row.cells, strict=True):
                for mark in ".,":
                    if column.role and is_number(cell) and mark in cell:
                        found.setdefault(mark, (row, f"{cell} in column {column.title!r}"))
        if len(found) == 2:
            (other, point), (row, comma) = found["."], found[","]
            raise fault(
                row,
                f"{comma} has a decimal comma, and {point} on line {other.line} a decimal point",
            )

    def place(self, role: str, joint: int = -1) -> int | None:
        """Return the index of the column of a role; None: there is none."""
        for k, column in enumerate(self.columns):
            if (column.role, column.joint) == (role, joint):
                return k
        return None

    def is_empty(self, row: Row, places: Sequence[int]) -> bool:
        """Whether a row says nothing in some columns."""
        return not any(row.cells[k] for k in places)

    def number(self, row: Row, place: int) -> float:
        """Return the number of a cell, in the unit in which it is written.

        Raises:
            InvalidRequest: It is no finite number; names line and column.
        """
        cell = row.cells[place]
        try:
            value = float(cell.replace(",", ".")) if is_number(cell) else math.nan
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            title = self.columns[place].title
            what = f"{cell[:_SHOWN]!r} is" if cell else "the cell is empty and"
            raise fault(row, f"{what} not a finite number", column=title, allowed="a number")
        return value

    def numbers(self, places: Sequence[int]) -> list[float]:
        """Return every number of some columns, rows that say nothing in all of them left out."""
        return [
            self.number(row, k)
            for row in self.rows
            if not self.is_empty(row, places)
            for k in places
        ]
