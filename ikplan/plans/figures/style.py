"""What all figures share: one style, colours told apart by everyone, bytes without a clock."""

from __future__ import annotations

from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import matplotlib.style

from ikplan.errors import InvalidRequest

__all__ = [
    "COLOURS",
    "IMAGE_SUFFIXES",
    "METADATA",
    "check_image_suffix",
    "colour",
    "line_style",
    "style",
]

IMAGE_SUFFIXES = (".png", ".svg", ".pdf")

# Okabe and Ito's palette: told apart by every kind of colour vision.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#8A8A00")
_STYLE: dict[str, Any] = {
    "axes.edgecolor": "#888888",
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "axes.titleweight": "bold",
    "font.size": 9,
    "grid.color": "#E4E4E4",
    "grid.linewidth": 0.7,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.5,
    "svg.hashsalt": "ikplan",
    "xtick.color": "#555555",
    "ytick.color": "#555555",
}
# Whatever would tell the time of day or the version of the library.
METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": None},
    ".pdf": {"CreationDate": None, "Creator": None, "Producer": None},
}


def check_image_suffix(path: str | Path) -> str:
    """Return the suffix of an image file.

    Raises:
        InvalidRequest: No image can be written with that suffix.
    """
    suffix = Path(path).suffix.lower()
    if suffix not in IMAGE_SUFFIXES:
        raise InvalidRequest(
            f"cannot draw to {str(path)!r}; name the file with one of {', '.join(IMAGE_SUFFIXES)}",
            field="plot",
            allowed=list(IMAGE_SUFFIXES),
        )
    return suffix


def style() -> AbstractContextManager[None]:
    """Return our style for what is drawn inside, whatever the user's own settings are."""
    return matplotlib.style.context(["default", _STYLE])


def colour(joint: int) -> str:
    """Return the colour of a joint."""
    return COLOURS[joint % len(COLOURS)]


def line_style(joint: int) -> str:
    """Return the line style of a joint: another one when the colours have all been used."""
    return ("-", "--", ":")[joint // len(COLOURS) % 3]
