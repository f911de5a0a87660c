"""The timed samples as a URScript program of ``servoj`` steps, for Universal Robots arms."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ikplan.errors import InvalidRequest
from ikplan.export.formats import Format

if TYPE_CHECKING:
    from ikplan.result import Plan

__all__ = ["FORMAT", "ROBOTS"]

ROBOTS = ("ur3", "ur5", "ur10")
"""The arms whose controllers run the program."""

# To the first sample at a walk: whoever runs the program stands beside it.
_APPROACH = "a=0.5, v=0.25"
_SERVO = "lookahead_time=0.1, gain=300"


def encode(plan: Plan) -> bytes:
    """Return the program: a slow ``movej`` to the first sample, then one ``servoj`` a step.

    Joint values are in rad, with every digit; each step lasts as long as its samples are apart.
    The controller's script interface runs the function as it comes in; a program that includes
    the file calls ``ikplan_trajectory()``.

    Raises:
        InvalidRequest: The plan is not for a Universal Robots arm.
    """
    if plan.robot not in ROBOTS:
        raise InvalidRequest(
            f"a URScript program is for {', '.join(ROBOTS)}, not for {plan.robot!r}",
            field="format",
            allowed=list(ROBOTS),
        )
    motion = plan.trajectory
    q = motion.q.tolist()
    lines = [
        "def ikplan_trajectory():",
        f"  # plan {plan.id} for {plan.robot}: {len(q)} samples in {plan.duration:.6f} s",
        f"  movej({q[0]}, {_APPROACH})",
    ]
    steps = np.diff(motion.time).tolist()
    lines += [
        f"  servoj({row}, t={step}, {_SERVO})" for row, step in zip(q[1:], steps, strict=True)
    ]
    lines += ["  stopj(2.0)", "end"]
    return ("\n".join(lines) + "\n").encode()


FORMAT = Format(
    name="urscript",
    title="a URScript program of servoj steps, for ur3, ur5 and ur10",
    suffixes=(".script",),
    media_type="text/x-urscript",
    encode=encode,
)
