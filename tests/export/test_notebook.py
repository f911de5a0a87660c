"""A plan in a notebook: figures, tables, and a line of text."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import ikplan
from ikplan import InvalidRequest, Plan

from .plans import rest_to_rest
from .test_plotting import plan_of


@pytest.fixture(scope="module")
def plan() -> Plan:
    return plan_of("ur5")


def test_plot_returns_the_figure_that_it_writes(plan: Plan, tmp_path: Path) -> None:
    figure = plan.plot(tmp_path / "a.png")
    assert isinstance(figure, Figure)
    plan.plot().savefig(tmp_path / "b.png")
    assert (tmp_path / "b.png").stat().st_size > 5000


def test_plot_draws_into_axes(plan: Plan) -> None:
    figure = Figure()
    positions, velocities = figure.subplots(2)
    assert plan.plot(axes=(positions, velocities)) is figure
    drawn = positions.get_lines()[0]
    np.testing.assert_allclose(np.radians(drawn.get_ydata()), plan.q[:, 0])
    limits = ikplan.load_robot("ur5").velocity_limit
    np.testing.assert_allclose(velocities.get_lines()[2].get_ydata(), plan.dq[:, 2] / limits[2])
    alone = Figure().subplots()
    plan.plot(axes=alone)
    assert len(alone.get_lines()) == 12
    with pytest.raises(InvalidRequest, match="axes"):
        plan.plot(axes=list(Figure().subplots(1, 3)))


def test_plot_of_an_unknown_robot_needs_no_limits() -> None:
    unknown = rest_to_rest(3, 9, ("rad", "m", "rad"))
    axes = Figure().subplots(1, 2)
    unknown.plot(axes=axes)
    assert "deg or m" in axes[0].get_ylabel()
    assert "rad/s" in axes[1].get_ylabel()


def test_representation_is_a_line(plan: Plan) -> None:
    assert len(repr(plan)) < 200
    assert repr(plan).startswith("Plan('ur5', ")
    assert plan.id in repr(plan)


def test_html_holds_figure_and_certificate(plan: Plan) -> None:
    text = plan._repr_html_()
    image = re.search(r"base64,([^\"]+)", text)
    assert image is not None
    assert base64.b64decode(image[1]).startswith(b"\x89PNG")
    assert "velocity limits" in text
    assert text == plan._repr_html_()


def test_frame_holds_every_sample(plan: Plan) -> None:
    pytest.importorskip("pandas")
    frame = plan.to_dataframe()
    np.testing.assert_array_equal(frame.index, plan.time)
    np.testing.assert_array_equal(frame["dq " + plan.joint_names[2]], plan.dq[:, 2])
    assert frame.attrs["units"]["ddq " + plan.joint_names[0]] == "rad/s^2"
    text = io.StringIO()
    frame.to_csv(text)
    assert len(text.getvalue().splitlines()) == len(plan.time) + 1
