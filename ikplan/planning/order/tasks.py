"""Tasks of a path in free order: what is done as a whole, in the order written."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from ikplan.documents.path import PathRequest
from ikplan.documents.scene import AttachedBody
from ikplan.documents.segment import JointSegment, MoveSegment

__all__ = ["Place", "Task", "tasks_of"]

Place = Literal["any", "first", "last"]


@dataclass(frozen=True)
class Task:
    """Parts of a path, waypoints or segments, that follow each other in any order of the tasks.

    Attributes:
        first: Number of the first part.
        last: Number of the last one.
        place: Where among the tasks it comes.
    """

    first: int
    last: int
    place: Place = "any"

    @property
    def parts(self) -> range:
        """Numbers of its parts."""
        return range(self.first, self.last + 1)


def tasks_of(path: PathRequest, attached: Sequence[AttachedBody]) -> list[Task]:
    """Return the tasks of a path, as they are written.

    Each waypoint is a task. Of segments, a task begins at each move or joint motion; one that
    begins otherwise is the first. What is carried over several tasks makes one of them; what is
    carried from the start makes the first one, what is carried to the end the last one.

    Args:
        path: The path.
        attached: What the tool carries.
    """
    if path.waypoints is not None:
        count = len(path.waypoints)
        begins = set(range(count))
    else:
        segments = path.segments or ()
        count = len(segments)
        begins = {k for k, s in enumerate(segments) if isinstance(s, MoveSegment | JointSegment)}
    head, tail = 0, count
    if 0 not in begins:
        head = min(begins, default=count)
    for body in attached:
        first, last = body.first_segment, body.last_segment
        if first is None and last is None:
            continue
        first, last = first or 0, count - 1 if last is None else min(last, count - 1)
        begins -= set(range(first + 1, last + 1))
        if body.first_segment is None:
            head = max(head, last + 1)
        if body.last_segment is None:
            tail = min(tail, first)
    if path.stay_last:
        tail = min(tail, count - path.stay_last)
    # A part is of the task that begins at or before it.
    cuts = sorted(begins | {0})
    head = next((cut for cut in cuts if cut >= head), count)
    tail = max((cut for cut in cuts if cut <= tail), default=0) if tail < count else count
    inner = [cut for cut in cuts if head <= cut < tail]
    tasks = [Task(0, min(head, count) - 1, "first")] if head > 0 else []
    ends = [*inner[1:], max(tail, head)] if inner else []
    tasks += [Task(begin, end - 1) for begin, end in zip(inner, ends, strict=True)]
    tail = max(tail, head)
    if tail < count:
        tasks.append(Task(tail, count - 1, "last"))
    return tasks
