"""How many processors this process may use: in a container, fewer than the machine has."""

from __future__ import annotations

import contextlib
import math
import os
from collections.abc import Iterator
from pathlib import Path, PurePosixPath

__all__ = ["processor_count"]

_MEMBERSHIP = Path("/proc/self/cgroup")
_GROUPS = Path("/sys/fs/cgroup")


def processor_count(membership: Path = _MEMBERSHIP, groups: Path = _GROUPS) -> int:
    """Return how many processors this process may use, at least 1.

    Those that it may run on (affinity, cpusets), and no more than the share of time that its
    control groups allow (cgroup v2 ``cpu.max``, v1 ``cpu.cfs_quota_us``), rounded up.

    Args:
        membership: The file that tells the control groups of this process.
        groups: The folder where control groups are mounted.
    """
    quota = min(_quotas(membership, groups), default=math.inf)
    allowed = _allowed()
    return allowed if quota >= allowed else max(1, math.ceil(quota))


def _allowed() -> int:
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _quotas(membership: Path, groups: Path) -> Iterator[float]:
    """The processors' worth of time of each control group that this process is in."""
    try:
        lines = membership.read_text().splitlines()
    except OSError:
        return  # no Linux, or no entry: nothing is limited that way
    for line in lines:
        _, _, rest = line.partition(":")
        controllers, _, group = rest.partition(":")
        if not controllers:
            mounts, read = [groups], _quota_v2
        elif "cpu" in controllers.split(","):
            mounts, read = [groups / controllers, groups / "cpu"], _quota_v1
        else:
            continue
        # Every group above has a say too. In a container the groups above its own are not there
        # to be read, and its own may be mounted as the root.
        path = PurePosixPath(group.lstrip("/"))
        for mount in mounts:
            for part in (path, *path.parents):
                with contextlib.suppress(OSError, ValueError, ZeroDivisionError):
                    yield read(mount / part)


def _quota_v2(group: Path) -> float:
    quota, period = (group / "cpu.max").read_text().split()
    return math.inf if quota == "max" else int(quota) / int(period)


def _quota_v1(group: Path) -> float:
    quota = int((group / "cpu.cfs_quota_us").read_text())
    return math.inf if quota < 0 else quota / int((group / "cpu.cfs_period_us").read_text())
