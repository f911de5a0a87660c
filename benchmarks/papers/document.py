"""The report being written: Markdown and its figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from benchmarks.papers.claims import VERDICTS, Claim, against, short, told
from benchmarks.papers.statistics import Estimate

__all__ = ["Document", "number", "slashed"]


def number(value: object) -> str:
    """Write a number with four significant digits, anything else as it is."""
    if isinstance(value, str):
        return value
    if value is None:
        return "-"
    v = float(value)  # type: ignore[arg-type]
    if math.isnan(v):
        return "-"
    if v == 0.0 or (math.isfinite(v) and v == int(v) and abs(v) < 1e7):
        return f"{int(v):,d}"
    if 1e-3 <= abs(v) < 1e5:
        return f"{v:.4g}" if abs(v) < 1e3 else f"{v:,.0f}"
    return f"{v:.3g}"


def slashed(values: Sequence[float] | None) -> str:
    """Write numbers with slashes in between."""
    if values is None:
        return "-"
    return " / ".join(number(v) for v in values)


class Document:
    """Markdown with figures beside it.

    Args:
        folder: Where figures go.
        prefix: Path of that folder as the Markdown refers to it.
    """

    def __init__(self, folder: Path, prefix: str) -> None:
        self.folder = folder
        self.prefix = prefix
        self.lines: list[str] = []
        self.claims: list[Claim] = []

    def claim(
        self, subject: str, published: str, ours: str, n: str, test: str, verdict: str
    ) -> None:
        """Add a line to the summary of the whole report."""
        if verdict not in VERDICTS:
            raise ValueError(f"verdict {verdict!r} is none of {', '.join(VERDICTS)}")
        self.claims.append(Claim(subject, published, ours, n, test, verdict))

    def figure_claim(
        self, subject: str, published: float, ours: Estimate, unit: str, more: str = ""
    ) -> None:
        """Add a line on one figure, decided by the interval of its ratio to the published one."""
        ratio = f"{short(ours.value / published)} times as large"
        ratio += f" ({short(ours.low / published)} to {short(ours.high / published)})"
        self.claim(
            subject,
            f"{published:g} {unit}".strip(),
            told(ours, unit) + (f"; {more}" if more else ""),
            ours.n,
            f"bootstrap: {ratio}",
            against(published, ours),
        )

    @contextmanager
    def details(self, summary: str) -> Iterator[None]:
        """Fold what is added meanwhile under a line of its own."""
        self.lines += [f"<details><summary>{summary}</summary>", ""]
        yield
        self.lines += ["</details>", ""]

    def heading(self, text: str, level: int = 2) -> None:
        """Add a heading."""
        self.lines += ["#" * level + " " + text, ""]

    def say(self, *paragraphs: str) -> None:
        """Add paragraphs."""
        for paragraph in paragraphs:
            self.lines += [paragraph, ""]

    def table(
        self, head: Sequence[str], rows: Sequence[Sequence[object]], *, words: bool = False
    ) -> None:
        """Add a table; numbers are written with four digits, and to the right but for words."""
        self.lines.append("| " + " | ".join(head) + " |")
        sides = [" --- " if words or i == 0 else " ---: " for i in range(len(head))]
        self.lines.append("|" + "|".join(sides) + "|")
        self.lines += ["| " + " | ".join(number(v) for v in row) + " |" for row in rows]
        self.lines.append("")

    def figure(self, figure: Figure, name: str, caption: str) -> None:
        """Save a figure as PNG and refer to it."""
        self.folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(self.folder / f"{name}.png", dpi=80, metadata={"Software": None})
        plt.close(figure)
        self.lines += [f"![{caption}]({self.prefix}/{name}.png)", "", f"*{caption}*", ""]

    def text(self) -> str:
        """Return the Markdown."""
        return "\n".join(self.lines).rstrip() + "\n"
