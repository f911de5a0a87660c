"""The notebook about the service runs against a service."""

from __future__ import annotations

import numpy as np
import pytest

from tests import notebooks


def test_the_notebook_of_the_service_runs(
    live_address: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SERVICE_URL", live_address)
    names, shown = notebooks.run("service")
    plan, later = names["plan"], names["later"]
    np.testing.assert_allclose(plan.q[-1], [0.6, -1.3, 1.5, -1.8, -1.57, 0.4], atol=1e-9)
    assert later.duration == pytest.approx(plan.duration, abs=0.01)
    assert later.time[1] == pytest.approx(1 / 500)
    assert any(isinstance(value, dict) and "version" in value for value in shown)
    assert "'ur5'" in capsys.readouterr().out
