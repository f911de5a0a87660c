"""The notebooks of the examples run from the first cell to the last, and are committed clean."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure

import ikplan
from ikplan.ik import registry
from tests import notebooks

NAMES = sorted(file.stem for file in notebooks.FOLDER.glob("*.ipynb"))


@pytest.fixture(autouse=True)
def closed_figures() -> Iterator[None]:
    plt.switch_backend("agg")
    yield
    plt.close("all")


@pytest.mark.parametrize("name", NAMES)
def test_a_notebook_is_committed_without_outputs(name: str) -> None:
    document = notebooks.read(name)
    assert (document["nbformat"], document["nbformat_minor"]) == (4, 5)
    ids = [cell["id"] for cell in document["cells"]]
    assert len(set(ids)) == len(ids)
    for cell in document["cells"]:
        assert cell["source"]
        if cell["cell_type"] == "code":
            assert cell["outputs"] == []
            assert cell["execution_count"] is None
            ast.parse("".join(cell["source"]))
        else:
            assert cell["cell_type"] == "markdown"
    assert document["cells"][0]["source"][0].startswith("# ")


def test_the_notebook_of_plans_runs(capsys: pytest.CaptureFixture[str]) -> None:
    names, shown = notebooks.run("plan")
    plan = names["plan"]
    assert isinstance(plan, ikplan.Plan)
    assert "<svg" in plan._repr_html_() or "<img" in plan._repr_html_()
    # The tool keeps to the speed that the request allows, and gets near to it.
    assert names["speed"].max() <= 0.25 * 1.001
    assert names["speed"].max() > 0.24
    assert isinstance(shown[-2], Figure)
    said = capsys.readouterr().out
    assert "m short" in said
    assert said.splitlines()[0] == repr(plan)


def test_the_notebook_of_solvers_runs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(registry, "_registered", dict(registry._registered))
    names, shown = notebooks.run("compare")
    assert len(names["rows"]) == 4 * 5 * 3
    assert all(row["evaluations"] <= 600 for row in names["rows"])
    assert any(isinstance(value, Figure) for value in shown)
    assert np.isfinite(shown[-1]).all()
    assert shown[-1].shape == (3,)
    assert "shrinking-cloud" in capsys.readouterr().out
