"""How far a plan is, on a terminal."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ikplan.client import PlanJob
    from ikplan.plans.plan import Plan

__all__ = ["progress_bar", "watched"]

Progress = Callable[[str, int, int], None]


@contextlib.contextmanager
def progress_bar(*, quiet: bool = False) -> Iterator[Progress | None]:
    """Show a bar on stderr while something is done.

    Args:
        quiet: Show none.

    Yields:
        What to tell the stage and how many of how many waypoints are done; None where nobody
        would see it, since stderr is no terminal.
    """
    if quiet or not sys.stderr.isatty():
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


def watched(answer: Callable[[], Plan], submit: Callable[[], PlanJob], *, quiet: bool) -> Plan:
    """Let a service make a plan; where somebody looks, with a bar that shows how far it is.

    Args:
        answer: Asks for the plan and waits.
        submit: Asks for the plan as a job.
        quiet: Show no bar.
    """
    with progress_bar(quiet=quiet) as progress:
        if progress is None:
            return answer()
        job = submit()
        try:
            return job.wait(progress=lambda s: progress(s.stage or s.state, s.done, s.total))
        except KeyboardInterrupt:
            job.cancel()
            raise
