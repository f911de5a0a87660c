"""A CSV text as a table of cells: its separator, its header, its decimal mark."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from dataclasses import dataclass

from ikplan.errors import InvalidRequest

__all__ = ["Row", "Table", "fault", "has_no_header", "is_number", "read_table"]

_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?")
_COMMENT = ("#", "//", "%", "!")
_SEPARATOR_LINE = re.compile(r"sep=(.)", re.IGNORECASE)
_UNIT_OF_ITS_OWN = re.compile(r"\s*[\[({]")
_NAMES = {",": "commas", ";": "semicolons", "\t": "tabs", " ": "spaces"}


@dataclass(frozen=True)
class Row:
    """A line of the file.

    Attributes:
        line: Its number, from 1.
        cells: Its cells, without blanks around them.
    """

    line: int
    cells: list[str]


@dataclass(frozen=True)
class Table:
    """The cells of a file.

    Attributes:
        header: The names of the columns; None: the file has none.
        rows: The rows of data.
        separator: What stands between cells; a space: any number of blanks.
        comments: Comment lines before the first row that may name the columns, last one first.
    """

    header: Row | None
    rows: list[Row]
    separator: str
    comments: list[Row]

    @property
    def separator_name(self) -> str:
        """The separator, in words."""
        return _NAMES.get(self.separator, repr(self.separator))


def fault(
    row: Row | int, detail: str, *, column: str = "", allowed: object = None
) -> InvalidRequest:
    """Return the error of a line and, where it is known, of a column."""
    line = row if isinstance(row, int) else row.line
    place = f"line {line}, column {column!r}" if column else f"line {line}"
    return InvalidRequest(f"{place}: {detail}", field=place.replace("'", ""), allowed=allowed)


def is_number(cell: str) -> bool:
    """Whether a cell is a number, with a point or a comma before its decimals."""
    return _NUMBER.fullmatch(cell) is not None


def read_table(data: bytes) -> Table:
    """Split the bytes of a file into cells.

    Raises:
        InvalidRequest: They are no text, or no table.
    """
    lines = list(_lines(_decoded(data)))
    separator = ""
    if lines and (told := _SEPARATOR_LINE.fullmatch(lines[0][1].strip())):
        separator = told[1]
        del lines[0]
    comments = [(n, t.strip().lstrip("#/%! ")) for n, t in lines if t.lstrip().startswith(_COMMENT)]
    lines = [(n, t) for n, t in lines if t.strip(" \t,;") and not t.lstrip().startswith(_COMMENT)]
    if not lines:
        raise fault(1, "the file has no line with values", allowed="a table of points")
    plain = [(n, t) for n, t in lines if not t.lstrip().startswith(";")]
    separator = separator or _separator_of((plain or lines)[0][1])
    if separator != ";" and plain:  # a semicolon begins a comment then
        lines = plain
    rows = [Row(n, _cells(n, text, separator)) for n, text in lines]
    named = not any(is_number(cell) for cell in rows[0].cells)
    before = [
        Row(n, _cells(n, text, _separator_of(text) if text else separator))
        for n, text in reversed(comments)
        if n < rows[0].line
    ]
    header = rows.pop(0) if named else None
    width = max(len(row.cells) for row in ([header] if header else rows))
    return Table(header, [_trimmed(row, width) for row in rows], separator, before)


def has_no_header(data: bytes) -> bool:
    """Whether no line of a file can be one of names.

    Raises:
        InvalidRequest: It is no text, or no table.
    """
    table = read_table(data)
    width = len(table.rows[0].cells) if table.rows else 0
    return table.header is None and not any(len(c.cells) == width for c in table.comments)


def _decoded(data: bytes) -> str:
    if data.startswith((b"\xff\xfe", b"\xfe\xff")):
        encodings = ["utf-16"]  # what Excel calls Unicode text
    else:
        encodings = ["utf-8-sig", "cp1252"]
    for encoding in encodings:
        try:
            text = data.decode(encoding)
        except UnicodeDecodeError:
            continue
        if "\0" not in text:
            return text
    raise InvalidRequest("the file is no text that can be read as CSV", allowed="a CSV file")


def _lines(text: str) -> Iterator[tuple[int, str]]:
    for number, line in enumerate(text.splitlines(), start=1):
        if line.strip():
            yield number, line


def _separator_of(line: str) -> str:
    """What stands between the cells of a first line."""
    for mark in "\t;":
        if mark in line.strip(mark):
            return mark
    words = line.split()
    # 0,5 0,2 0,3: the commas are those of decimals.
    decimals = len(words) > 1 and all(is_number(word) for word in words)
    return "," if "," in line and not decimals else " "


def _cells(number: int, text: str, separator: str) -> list[str]:
    if separator == " ":
        cells: list[str] = []
        for word in text.split():
            # x [mm]: the unit belongs to the name before it.
            if cells and _UNIT_OF_ITS_OWN.match(word) and not cells[-1].endswith(("]", ")")):
                cells[-1] += f" {word}"
            else:
                cells.append(word.strip("\"'"))
        return cells
    try:
        parsed = next(csv.reader([text], delimiter=separator, skipinitialspace=True), [])
    except csv.Error as error:
        raise fault(number, f"the line cannot be split into cells: {error}") from error
    return [cell.strip() for cell in parsed]


def _trimmed(row: Row, width: int) -> Row:
    """A row without the empty cells that stand beyond the last column."""
    count = len(row.cells)
    while count > width and not row.cells[count - 1]:
        count -= 1
    return Row(row.line, row.cells[:count])
