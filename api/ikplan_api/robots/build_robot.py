"""Build of one uploaded robot in a process of its own.

``python -m ikplan_api.robots.build_robot BYTES SECONDS`` reads an upload from standard input,
limits its own memory and processor time, and writes the result to standard output: a JSON object
with either ``info`` or ``problem``. The service unpickles nothing.
"""

from __future__ import annotations

import json
import os
import resource
import sys
from typing import Any

__all__ = ["build_upload", "main"]


def main() -> None:
    """Build the robot read from standard input."""
    # Pinocchio and its parsers may print; standard output must carry the result only.
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
    json.dump(build_upload(document), verdict, allow_nan=False)
    verdict.flush()


def build_upload(document: bytes) -> dict[str, Any]:
    """Build an upload; return its description or the problem document."""
    from ikplan.errors import IkplanError
    from ikplan.robots import RobotUpload

    try:
        robot = RobotUpload.stored(document).robot()
        # What a worker will use: memory for the dynamics, and both kinematics.
        robot.fk(robot.home)
        robot.jacobian(robot.home)
        return {"info": robot.info().model_dump(mode="json")}
    except IkplanError as error:
        return {"problem": error.to_problem()}


if __name__ == "__main__":
    main()
