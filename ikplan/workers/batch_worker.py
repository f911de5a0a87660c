"""What a process does that plans the lines of a batch."""

from __future__ import annotations

import traceback
from typing import TYPE_CHECKING

from ikplan.documents import load_json
from ikplan.errors import IkplanError
from ikplan.workers.child import Fault, set_up

if TYPE_CHECKING:
    from ikplan.robots import Robot

__all__ = ["begin", "make"]

_robot: list[Robot | None] = [None]


def begin(robot: Robot | None) -> None:
    """Set the process up.

    Args:
        robot: The robot of every line; None: the one that each names.
    """
    _robot[0] = robot
    set_up()


def make(line: bytes) -> bytes:
    """Plan a line.

    Args:
        line: A request, JSON.

    Returns:
        The plan, JSON.

    Raises:
        IkplanError: The verdict on the request.
    """
    from ikplan.pipeline.plan import plan

    try:
        document, robot = load_json(line), _robot[0]
        if robot is not None and isinstance(document, dict):
            document["robot"] = robot.name
        return plan(document, robot=robot).model_dump_json().encode()
    except IkplanError:
        raise
    except Exception:
        raise Fault(traceback.format_exc()) from None
