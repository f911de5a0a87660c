"""How faults are found in a module, planted, and kept out of what is compiled."""

from __future__ import annotations

from pathlib import Path

import pytest

from benchmarks.mutants.drawing import draw, possible
from benchmarks.mutants.kernels import changes_kernels
from benchmarks.mutants.mutant import Mutant, StaleMutantError
from benchmarks.mutants.operators import faults_of
from benchmarks.mutants.server import dependents, imports_of


def results(source: str) -> set[str]:
    """The module with each of its faults."""
    return {source[: f.begin] + f.new + source[f.end :] for f in faults_of(source)}


@pytest.mark.parametrize(
    ("source", "mutated"),
    [
        ("a = b < c\n", {"a = b <= c\n", "a = b >= c\n"}),
        ("a = (b) >= (c)\n", {"a = (b) > (c)\n", "a = (b) < (c)\n"}),
        ("a = b is not None\n", {"a = b is None\n"}),
        ("a = b + c * d\n", {"a = b - c * d\n", "a = b + c / d\n"}),
        ("a = b and c\n", {"a = b or c\n"}),
        ("a = -b\n", {"a = (b)\n"}),
        ("a = 3\n", {"a = 4\n"}),
        ("a = 1e-3\n", {"a = 0.01\n"}),
        ("a = 0.0\n", {"a = 1.0\n"}),
        ("a = True\n", {"a = False\n"}),
        ("a = np.minimum(b, c)\n", {"a = np.maximum(b, c)\n"}),
        ("a = b.max()\n", {"a = b.min()\n"}),
        ("a = abs(b)\n", {"a = (b)\n"}),
        ("f(b)\n", {"pass\n"}),
        ("a += b\n", {"pass\n"}),
        ("if b:\n    a = c\n", {"if (not (b)):\n    a = c\n"}),
        ('raise E("é", 3)\n', {"pass\n"}),
        ("def f(a: int = 1) -> float:\n    return a\n", {
            "def f(a: int = 2) -> float:\n    return a\n",
            "def f(a: int = 1) -> float:\n    return 0.0\n",
        }),
    ],
)  # fmt: skip
def test_each_kind_of_fault_is_made(source: str, mutated: set[str]) -> None:
    assert results(source) == mutated


@pytest.mark.parametrize(
    "source",
    [
        '"""Docstring: 1 < 2."""\n',
        "__all__ = ['a', 'b']\n",
        "import a.b\nfrom c import d\n",
        "Both = A | B\n",
        "def f(a: int | None, b: Annotated[int, Ge(3)]) -> A | None: ...\n",
        "@decorated(3)\ndef f(): ...\n",
        "@dataclass(frozen=True)\nclass A:\n    b: Annotated[int, 3]\n",
        "a = f'{b * 1e3:.1f} mm'\n",
        "assert a < 3\n",
        "for a, b in zip(c, d, strict=True): ...\n",
        "if TYPE_CHECKING:\n    a = 3\n",
    ],
)
def test_what_is_for_readers_and_for_the_type_checker_stays(source: str) -> None:
    assert results(source) == set()


def test_text_before_a_fault_may_be_of_any_length_in_bytes() -> None:
    assert results("a = {'é': b < c}\n") == {"a = {'é': b <= c}\n", "a = {'é': b >= c}\n"}


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("x = 9", "x = 2", "0 times"),
        ("= 1", "= 2", "2 times"),
        ("x = 1", "x = 1", "its new text"),
        ("x = 1", "x = (", "no Python"),
    ],
)
def test_a_stale_mutant_is_an_error(old: str, new: str, says: str) -> None:
    mutant = Mutant("m", "file.py", old, new)
    with pytest.raises(StaleMutantError, match=says) as caught:
        mutant.apply("x = 1\ny = 1\n")
    assert caught.value.mutant is mutant


@pytest.mark.parametrize(
    ("old", "new", "lines"),
    [
        ("b = 2", "b = 3", ("b = 2", "b = 3")),
        ("f(\n    b\n)\n", "pass\n", ("f( b )", "pass")),
        ("b = 2\n", "", ("b = 2", "")),
        ("b = 2\n", "b = 2\nb = 2\n", ("", "b = 2")),
        ("c = 4", "c = 5", ("c = 4", "c = 5")),
    ],
)
def test_the_lines_changed_are_told(old: str, new: str, lines: tuple[str, str]) -> None:
    source = "a = 1\nb = 2\nf(\n    b\n)\nc = 4"
    assert Mutant("m", "file.py", old, new).changed_lines(source) == lines


def test_a_change_elsewhere_leaves_most_of_a_draw_as_it_was(tmp_path: Path) -> None:
    lines = [f"a{k} = b{k} < c{k} + {k}" for k in range(200)]
    file = tmp_path / "m.py"
    file.write_text("\n".join(lines))
    before = {(m.old, m.new, m.name) for m in draw(tmp_path, ["m.py"], 50, 3)}
    file.write_text("\n".join(["x = y * z", *lines[:150]]))
    after = {(m.old, m.new, m.name) for m in draw(tmp_path, ["m.py"], 50, 3)}
    assert len(before & after) > 25


KERNELS = """from ikplan._jit import kernel
LIMIT = 1.0
@kernel
def fast(a):
    return a < LIMIT
def plain(a):
    if a > 3:
        raise ValueError
    return fast(a)
"""


@pytest.mark.parametrize(
    ("old", "new", "interpreted"),
    [
        ("LIMIT = 1.0", "LIMIT = 10.0", True),
        ("a < LIMIT", "a <= LIMIT", True),
        ("a > 3", "a >= 3", False),
        ("        raise ValueError\n    return", "        pass\n    return", False),
        ("    if a > 3:\n        raise ValueError\n", "", True),
    ],
)
def test_kernels_run_uncompiled_only_where_a_mutant_changes_them(
    old: str, new: str, interpreted: bool
) -> None:
    assert changes_kernels(KERNELS, Mutant("m", "k.py", old, new)) is interpreted
    without = KERNELS.replace("from ikplan._jit import kernel", "from numba import njit as kernel")
    assert not changes_kernels(without, Mutant("m", "k.py", old, new))


def test_what_imports_a_module_is_imported_anew_with_it() -> None:
    known = ["p", "p.a", "p.b", "p.c", "p.d"]
    sources = {
        "p": "",
        "p.a": "import os\n",
        "p.b": "from p.a import x\n",
        "p.c": "from p import b\n",
        "p.d": "def f():\n    import p.a\nif TYPE_CHECKING:\n    import p.b\n",
    }
    imports = {name: imports_of(name, text, known) for name, text in sources.items()}
    assert imports == {"p": set(), "p.a": set(), "p.b": {"p.a"}, "p.c": {"p", "p.b"}, "p.d": set()}
    assert dependents("p.a", imports) == {"p.a", "p.b", "p.c"}
    assert dependents("p.c", imports) == {"p.c"}


def test_every_fault_of_a_module_is_one_mutant(tmp_path: Path) -> None:
    (tmp_path / "m.py").write_text("a = b < c\nd = b < c\na = b < c\n")
    mutants = possible(tmp_path, "m.py")
    assert [m.line for m in mutants] == [1, 1, 2, 2, 3, 3]
    assert len({m.name for m in mutants}) == 6
