"""How far a plan is, on a terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator

__all__ = ["progress_bar"]

Progress = Callable[[str, int, int], None]


@contextlib.contextmanager
def progress_bar() -> Iterator[Progress | None]:
    """Show a bar on stderr while something is done.

    Yields:
        What to tell the stage and how many of how many waypoints are done; None where nobody
        would see it, since stderr is no terminal.
    """
    if not sys.stderr.isatty():
        yield None
        return
    from tqdm import tqdm

    with tqdm(
        total=0,
        unit="waypoint",
        leave=False,
        file=sys.stderr,
        dynamic_ncols=True,
        bar_format="{desc} {n_fmt}/{total_fmt} |{bar}| {elapsed}",
    ) as bar:

        def tell(stage: str, done: int, total: int) -> None:
            bar.set_description_str(stage, refresh=False)
            # A stage that counts no waypoints is as good as done in no time.
            bar.total, bar.n = total or bar.total, done if total else bar.n
            bar.refresh()

        yield tell
