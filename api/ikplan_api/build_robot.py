"""Building one uploaded robot in a process of its own, which ends with it.

``python -m ikplan_api.build_robot BYTES SECONDS`` reads an upload from standard input, keeps its
own memory and processor time below the two bounds, and writes what became of it to standard
output: a JSON object with either ``info`` or ``problem``. Nothing that comes back is unpickled.
"""

from __future__ import annotations

import json
import os
import resource
import sys
from typing import Any

__all__ = ["main"]


def main() -> None:
    """Build the robot."""
    # Pinocchio and its parsers print as they like; only the verdict may reach the reader.
    verdict = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    memory, seconds = int(sys.argv[1]), int(sys.argv[2])
    document = sys.stdin.buffer.read()
    for bound, value in (
        (resource.RLIMIT_AS, memory),
        (resource.RLIMIT_CPU, seconds),
        (resource.RLIMIT_FSIZE, 0),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(bound, (value, value))
    json.dump(_build(document), verdict, allow_nan=False)
    verdict.flush()


def _build(document: bytes) -> dict[str, Any]:
    from ikplan.documents import parse_json
    from ikplan.errors import IkplanError
    from ikplan.robots import RobotUpload

    try:
        robot = parse_json(RobotUpload, document).robot()
        # What a worker will ask of it: memory for its dynamics, and both its kinematics.
        robot.fk(robot.home)
        robot.jacobian(robot.home)
        return {"info": robot.info().model_dump(mode="json")}
    except IkplanError as error:
        return {"problem": error.to_problem()}


if __name__ == "__main__":
    main()
