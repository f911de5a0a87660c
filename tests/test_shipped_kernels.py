"""Kernels that are shipped are found wherever they are installed, or compiled as ever."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from ikplan._kernels import pack as packs
from ikplan._kernels.turns import Turn, take_turn
from tests.test_jit import BASE, SOURCE, TOP

SCRIPT = """
import json
from ikplan.top import twice
print(json.dumps({"value": twice(3.0), "compiled": bool(twice.stats.cache_misses)}))
"""
PACKING = """
import json, sys
from pathlib import Path
from ikplan._kernels.pack import write_pack
print(json.dumps(write_pack(Path(sys.argv[1]), Path(sys.argv[2]))))
"""


class Installed:
    """A small package under the project's name, at a path of its own."""

    def __init__(self, root: Path, factor: float = 2.0) -> None:
        self.root, self.cache = root, root / "cache"
        inner = root / "ikplan" / "inner"
        inner.mkdir(parents=True)
        for folder in (root / "ikplan", inner):
            (folder / "__init__.py").touch()
        shutil.copy(SOURCE / "_jit.py", root / "ikplan")
        shutil.copy(SOURCE / "processor_time.py", root / "ikplan")
        shutil.copytree(SOURCE / "_kernels", root / "ikplan" / "_kernels")
        (inner / "base.py").write_text(BASE.format(factor=factor))
        (root / "ikplan" / "top.py").write_text(TOP)

    def run(self, script: str = SCRIPT, *arguments: str, **environment: str) -> tuple[Any, str]:
        """The answer of a script, and what it says on stderr."""
        done = subprocess.run(
            [sys.executable, "-P", "-c", script, *arguments],
            env={
                "PATH": os.environ["PATH"],
                "PYTHONPATH": str(self.root),
                "IKPLAN_CACHE_DIR": str(self.cache),
                "PYTHONDONTWRITEBYTECODE": "1",
                "HOME": str(self.root / "file"),
                **environment,
            },
            capture_output=True,
            text=True,
            check=True,
            cwd=self.root,
        )
        return json.loads(done.stdout), done.stderr

    def unwritable(self) -> None:
        """Leave no place where a kernel could be kept, not even for root."""
        shutil.rmtree(self.cache, ignore_errors=True)
        self.cache.write_text("a file in place of a folder")


@pytest.fixture(scope="module")
def pack(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What was compiled for any processor, in one file."""
    builder = Installed(tmp_path_factory.mktemp("builder"))
    file = tmp_path_factory.mktemp("shipped") / packs.PACK_NAME
    generic = {"NUMBA_CPU_NAME": "generic"}
    assert builder.run(**generic)[0] == {"value": 12.0, "compiled": True}
    # Two kernels, and what Python calls one of them by.
    assert builder.run(PACKING, str(builder.cache / "kernels"), str(file))[0] == 3
    return file


@pytest.mark.parametrize("how", ["within", "beside", "named"])
def test_nothing_is_compiled_elsewhere_where_nothing_can_be_written(
    pack: Path, tmp_path: Path, how: str
) -> None:
    user = Installed(tmp_path)
    user.unwritable()
    named = {}
    if how == "named":
        named["IKPLAN_KERNELS"] = str(pack)
    else:
        folder = tmp_path / ("ikplan" if how == "within" else "ikplan_kernels")
        folder.mkdir(exist_ok=True)
        (folder / "__init__.py").touch()
        shutil.copy(pack, folder)
    assert user.run(**named) == ({"value": 12.0, "compiled": False}, "")


def test_kernels_of_other_sources_are_compiled(pack: Path, tmp_path: Path) -> None:
    user = Installed(tmp_path, factor=5.0)
    answer, said = user.run(IKPLAN_KERNELS=str(pack))
    assert answer == {"value": 30.0, "compiled": True}
    assert said == "compiling kernels, once ...\n"


def test_an_empty_name_means_no_shipped_kernels(pack: Path, tmp_path: Path) -> None:
    user = Installed(tmp_path)
    shutil.copy(pack, tmp_path / "ikplan")
    assert user.run(IKPLAN_KERNELS="")[0]["compiled"] is True


def with_head(pack: Path, target: Path, **changes: Any) -> Path:
    """A pack with another head."""
    data = pack.read_bytes()
    begin = len(packs._MAGIC) + 8
    size = int.from_bytes(data[begin - 8 : begin], "little")
    head = json.loads(data[begin : begin + size])
    head = {**head, **changes, "stamp": {**head["stamp"], **changes.get("stamp", {})}}
    text = json.dumps(head).encode()
    target.write_bytes(packs._MAGIC + len(text).to_bytes(8, "little") + text + data[begin + size :])
    return target


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"stamp": {"numba": "0.1"}}, f"for numba 0.1, here is {packs.stamp()['numba']}"),
        ({"stamp": {"python": "cpython-27"}}, "for python cpython-27"),
        ({"stamp": {"machine": "vax"}}, "for machine vax"),
        ({"features": ["sse2", "abacus"]}, "for processors with abacus"),
    ],
)
def test_kernels_that_do_not_fit_are_told_of_and_compiled(
    pack: Path, tmp_path: Path, changes: dict[str, Any], reason: str
) -> None:
    other = with_head(pack, tmp_path / "other.pack", **changes)
    opened = packs.Pack(other)
    assert reason in opened.refusal
    assert opened.find(next(iter(opened._places))) is None
    assert packs.Pack(pack).refusal == ""


def test_whoever_compiles_is_told_why_shipped_kernels_do_not_fit(
    pack: Path, tmp_path: Path
) -> None:
    other = with_head(pack, tmp_path / "other.pack", stamp={"numba": "0.1"})
    answer, said = Installed(tmp_path / "user").run(IKPLAN_KERNELS=str(other))
    assert answer == {"value": 12.0, "compiled": True}
    assert said.startswith(f"compiling kernels, once ... (those of {other} are for numba 0.1")


@pytest.mark.parametrize("length", [0, 5, 30, -1])
def test_a_pack_that_was_cut_short_is_none(pack: Path, tmp_path: Path, length: int) -> None:
    short = tmp_path / "short.pack"
    short.write_bytes(pack.read_bytes()[:length])
    assert packs.read_pack(short) is None
    assert packs.read_pack(tmp_path / "none") is None


def test_a_pack_for_any_processor_needs_no_features(pack: Path) -> None:
    data = pack.read_bytes()
    assert b'"features": []' in data[:2000]
    assert len(packs.Pack(pack)) == 3


def test_a_kernel_that_is_compiled_elsewhere_is_waited_for(tmp_path: Path) -> None:
    script = (
        "import os, sys, time\n"
        "from pathlib import Path\n"
        "from ikplan._kernels.turns import Turn\n"
        "turn = Turn(Path(sys.argv[1]))\n"
        "print('taken', flush=True)\n"
        "sys.stdin.readline()\n"
        "Path(sys.argv[2]).write_text('compiled')\n"
        "turn.give_back()\n"
    )
    lock, made = tmp_path / "folder" / "lock", tmp_path / "made"
    other = subprocess.Popen(
        [sys.executable, "-c", script, str(lock), str(made)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    assert other.stdout is not None
    assert other.stdin is not None
    assert other.stdout.readline() == "taken\n"
    with pytest.raises(BlockingIOError):
        Turn(lock)
    other.stdin.write("\n")
    other.stdin.flush()
    found = take_turn(lock, lambda: made.read_text() if made.exists() else None)
    assert found == "compiled"
    other.communicate()
    turn = take_turn(lock, lambda: None)
    assert isinstance(turn, Turn)
    turn.give_back()
    assert not lock.exists()


def test_the_turn_of_a_process_that_ended_is_free(tmp_path: Path) -> None:
    lock = tmp_path / "lock"
    script = (
        "import os, sys; from pathlib import Path; from ikplan._kernels.turns import Turn; "
        "Turn(Path(sys.argv[1])); os._exit(0)"
    )
    subprocess.run([sys.executable, "-c", script, str(lock)], check=True)
    turn = take_turn(lock, lambda: None)
    assert isinstance(turn, Turn)
    turn.give_back()


def test_where_nothing_can_be_written_there_are_no_turns(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert take_turn(tmp_path / "file" / "lock", lambda: None) is None


def test_two_processes_compile_a_kernel_once(tmp_path: Path) -> None:
    user = Installed(tmp_path)
    environment = {
        "PATH": os.environ["PATH"],
        "PYTHONPATH": str(user.root),
        "IKPLAN_CACHE_DIR": str(user.cache),
        "HOME": str(tmp_path),
    }
    both = [
        subprocess.Popen(
            [sys.executable, "-P", "-c", SCRIPT], env=environment, stdout=subprocess.PIPE, text=True
        )
        for _ in range(2)
    ]
    answers = [json.loads(process.communicate()[0])["value"] for process in both]
    assert answers == [12.0, 12.0]
    assert len(list(user.cache.rglob("base.scaled-*.nbc"))) == 1
    # What Python calls the other by takes no turns.
    assert len(list(user.cache.rglob("top.twice-*.nbc"))) in (2, 3)
    assert not list(user.cache.rglob("*.lock"))


SUMS = """
import numpy as np
from ikplan._jit import kernel

@kernel
def total(count: int) -> float:
    return np.ones(count).sum()
"""
MEANS = """
import numpy as np
from ikplan._jit import kernel
from ikplan.sums import total

@kernel
def mean(count: int) -> float:
    table = {k: float(k) for k in range(count)}
    return total(count) / count + np.linspace(0.0, 1.0, count).mean() + len(table)
"""
LOADING = """
import json, sys
from ikplan.sums import total
value = total(4)
imported = sorted({"numba.np.arraymath", "numba.typed.typeddict"} & set(sys.modules))
print(json.dumps([value, bool(total.stats.cache_misses), imported]))
"""
COMPILING_AFTERWARDS = """
import json
from ikplan.sums import total
from ikplan.means import mean
print(json.dumps([total(4), mean(4), total(5), bool(total.stats.cache_misses)]))
"""


def test_what_is_loaded_needs_no_compiler_and_leaves_it_as_it_was(tmp_path: Path) -> None:
    user = Installed(tmp_path)
    (tmp_path / "ikplan" / "sums.py").write_text(SUMS)
    (tmp_path / "ikplan" / "means.py").write_text(MEANS)
    assert user.run(LOADING)[0][:2] == [4.0, True]
    assert user.run(LOADING)[0] == [4.0, False, []]
    assert user.run(COMPILING_AFTERWARDS)[0] == [4.0, 5.5, 5.0, False]
    assert user.run(COMPILING_AFTERWARDS) == ([4.0, 5.5, 5.0, False], "")
