"""How many workers there are by default: as many as the container may use."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from ikplan.workers.processors import processor_count
from ikplan_api.settings import Settings

SCOPE = "/system.slice/docker-1f.scope"


@pytest.fixture(autouse=True)
def eight(monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine on which this process may run on eight processors."""
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(8)))


def count(tmp_path: Path, membership: str, files: dict[str, str]) -> int:
    """The count where control groups say this."""
    told, groups = tmp_path / "cgroup", tmp_path / "groups"
    told.write_text(membership)
    for name, text in files.items():
        (groups / name).parent.mkdir(parents=True, exist_ok=True)
        (groups / name).write_text(text)
    return processor_count(told, groups)


V1 = f"12:memory:{SCOPE}\n4:cpu,cpuacct:{SCOPE}\n1:name=systemd:{SCOPE}\n"


@pytest.mark.parametrize(
    ("membership", "files", "wanted"),
    [
        # A container sees its own group as the root.
        ("0::/\n", {"cpu.max": "200000 100000\n"}, 2),
        ("0::/\n", {"cpu.max": "150000 100000\n"}, 2),
        ("0::/\n", {"cpu.max": "25000 100000\n"}, 1),
        ("0::/\n", {"cpu.max": "1600000 100000\n"}, 8),
        ("0::/\n", {"cpu.max": "max 100000\n"}, 8),
        ("0::/\n", {}, 8),
        # The strictest group on the way up counts.
        (f"0::{SCOPE}\n", {f"{SCOPE[1:]}/cpu.max": "400000 100000\n"}, 4),
        (
            f"0::{SCOPE}\n",
            {f"{SCOPE[1:]}/cpu.max": "max 100000\n", "system.slice/cpu.max": "300000 100000\n"},
            3,
        ),
        # A path of the host's that is not there, and its group mounted as the root.
        (f"0::{SCOPE}\n", {"cpu.max": "500000 100000\n"}, 5),
        # Version 1, its controller under the full or the short name.
        (
            V1,
            {
                f"cpu,cpuacct{SCOPE}/cpu.cfs_quota_us": "300000\n",
                f"cpu,cpuacct{SCOPE}/cpu.cfs_period_us": "100000\n",
            },
            3,
        ),
        (V1, {"cpu/cpu.cfs_quota_us": "50000\n", "cpu/cpu.cfs_period_us": "50000\n"}, 1),
        (V1, {"cpu/cpu.cfs_quota_us": "-1\n", "cpu/cpu.cfs_period_us": "100000\n"}, 8),
        # What makes no sense limits nothing.
        ("0::/\n", {"cpu.max": "many\n"}, 8),
        ("0::/\n", {"cpu.max": "100000 0\n"}, 8),
        ("nonsense\n", {}, 8),
    ],
)
def test_the_quota_of_a_container_counts(
    membership: str, files: dict[str, str], wanted: int, tmp_path: Path
) -> None:
    assert count(tmp_path, membership, files) == wanted


def test_where_nothing_is_told_the_processors_allowed_count(tmp_path: Path) -> None:
    assert processor_count(tmp_path / "none", tmp_path) == 8


def test_a_service_has_a_worker_for_each_of_them_unless_told_otherwise(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("ikplan_api.settings.service.processor_count", lambda: 3)
    assert Settings().worker_count == 3
    assert Settings(workers=5).worker_count == 5


def test_here_the_count_is_not_more_than_the_machine_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.undo()
    assert 1 <= processor_count() <= len(os.sched_getaffinity(0))
