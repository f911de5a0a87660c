"""A plan seen, compared and taken home: plots, colours, ghosts, programs, figure, report."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable

import numpy as np
import pinocchio as pin
import pytest
from playwright.sync_api import Page, expect

import ikplan
from ikplan.plans.export import encode
from ikplan.robots import catalogue_robot

from .actions import document, example, plan, saved, seek, write

Open = Callable[..., Page]


@pytest.fixture(scope="module")
def made() -> ikplan.Plan:
    """The plan of the example, by the library."""
    return ikplan.plan(example("curve_ur5"))


@pytest.fixture(scope="module")
def page(visit: Open) -> Page:
    """The page with that plan."""
    opened = visit("curve_ur5", width=1280, height=800)
    plan(opened)
    opened.wait_for_selector("#plots[data-series=ready]")
    return opened


def quantity(page: Page, name: str) -> None:
    page.get_by_role("group", name="Quantity").get_by_role("button", name=name, exact=True).click()


def test_every_quantity_is_plotted_with_the_value_of_the_moment(
    page: Page, made: ikplan.Plan
) -> None:
    index = len(made.time) // 3
    seek(page, index)
    robot = catalogue_robot("ur5").with_tool(example("curve_ur5")["tool"]["position"])
    quantity(page, "Jerk")
    expect(page.locator(".plot-row .uplot")).to_have_count(6)
    slope = np.degrees((made.ddq[index + 1] - made.ddq[index]) / np.diff(made.time)[index])
    told = [float(t.replace("−", "-")) for t in page.locator(".plot-row output").all_inner_texts()]
    np.testing.assert_allclose(told, slope, rtol=1e-3, atol=0.02)
    quantity(page, "Tool")
    h = 1e-5
    step = robot.fk(made.q[index] - h * made.dq[index]).actInv(
        robot.fk(made.q[index] + h * made.dq[index])
    )
    twist = pin.log6(step).vector / (2 * h)
    told = [float(t) for t in page.locator(".plot-row output").all_inner_texts()]
    assert told[0] == pytest.approx(np.linalg.norm(twist[:3]), abs=1e-3)
    assert told[1] == pytest.approx(np.degrees(np.linalg.norm(twist[3:])), abs=0.01)
    quantity(page, "Position")


def test_deviation_and_clearance_are_those_of_the_certificate(
    page: Page, made: ikplan.Plan
) -> None:
    quantity(page, "Deviation")
    time = made.certificate.max_path_deviation_time
    assert time is not None
    seek(page, int(np.searchsorted(made.time, time)))
    page.click("[data-unit=mm]")
    told = page.locator(".plot-row output").first.inner_text()
    assert float(told) == pytest.approx(1e3 * (made.certificate.max_path_deviation or 0), abs=1e-3)
    page.click("[data-unit=m]")
    quantity(page, "Clearance")
    expect(page.locator(".plot-row output")).to_have_text(re.compile(r"0\.\d+"))
    quantity(page, "Position")


def test_a_stretch_of_time_is_zoomed_into_in_all_plots(page: Page, made: ikplan.Plan) -> None:
    over = page.locator(".chart .u-over").nth(1)
    over.scroll_into_view_if_needed()
    box = over.bounding_box()
    assert box is not None
    page.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 20)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 20, steps=4)
    page.mouse.up()
    low, high = map(float, (page.get_attribute("#plots", "data-zoom") or "").split())
    assert low == pytest.approx(0.25 * made.duration, rel=0.05)
    assert high == pytest.approx(0.5 * made.duration, rel=0.05)
    page.get_by_role("button", name="Whole motion").click()
    low, high = map(float, (page.get_attribute("#plots", "data-zoom") or "").split())
    assert low == 0
    assert high == pytest.approx(made.duration)


def test_the_binding_limit_is_that_of_the_plan(page: Page, made: ikplan.Plan) -> None:
    spans = page.locator(".band-strip span")
    widths = spans.evaluate_all("all => all.map(s => [s.title, parseFloat(s.style.width)])")
    assert sum(width for _, width in widths) == pytest.approx(100, abs=0.1)
    assert made.timing is not None
    bound = sum(width for title, width in widths if title != "no limit binds")
    assert bound > 20


def test_ghosts_and_colours_of_the_path_are_shown(page: Page) -> None:
    for name in ("Start", "Goal", "Here"):
        page.get_by_role("button", name=name, exact=True).click()
    expect(page.locator("#stage")).to_have_attribute("data-ghosts", "start goal instant")
    for name in ("Start", "Goal", "Here"):
        page.get_by_role("button", name=name, exact=True).click()
    expect(page.locator("#stage")).to_have_attribute("data-ghosts", "")
    before = page.locator("#stage canvas").screenshot()
    page.select_option("#path-colour", "tool")
    page.wait_for_timeout(300)
    assert page.locator("#stage canvas").screenshot() != before
    page.select_option("#path-colour", "")


def test_every_format_of_the_robot_is_taken_home_as_the_library_writes_it(
    page: Page, made: ikplan.Plan
) -> None:
    card = page.locator(".downloads .actions").first
    expect(card).to_have_attribute("aria-busy", "false")
    labels = card.get_by_role("button").all_inner_texts()
    assert "urscript" in labels
    assert "rapid" not in labels
    theirs = ikplan.Plan.load(saved(page, "JSON"))
    for label in ("ROS", "ros-goal", "urscript"):
        assert saved(page, label).encode() == encode(theirs, label.lower())
    # What is taken home plays back as the plan that is shown.
    np.testing.assert_array_equal(theirs.q, made.q)


def test_figure_and_report_hold_the_certificate(page: Page) -> None:
    signals = 0
    for button in page.get_by_role("group", name="Quantity").get_by_role("button").all():
        button.click()
        signals += page.locator(".plot-row .uplot").count()
    quantity(page, "Position")
    figure = ET.fromstring(saved(page, "Figure"))
    assert figure.tag == "{http://www.w3.org/2000/svg}svg"
    curves = figure.findall(".//{http://www.w3.org/2000/svg}path")
    assert len(curves) == signals > 4 * 6 + 2
    report = saved(page, "Report")
    assert "every promise kept" in report
    assert "data:image/png;base64," in report
    assert not re.search(r"<script|<link|https?://(?!www\.w3\.org)", report)
    identity = page.locator(".downloads code").inner_text()
    assert identity in report


def test_two_plans_are_compared_side_by_side_and_in_step(page: Page) -> None:
    page.get_by_role("button", name="Keep to compare").click()
    slower = document(page)
    slower["limits"] = {**slower.get("limits", {}), "velocity_scale": 0.3}
    write(page, slower)
    expect(page.locator("#stale")).to_be_visible()
    plan(page)
    table = page.locator(".compare table")
    expect(table).to_contain_text("Duration")
    now, kept = (
        float(text.split(" s")[0])
        for text in table.locator("tbody tr").first.locator("td").all_inner_texts()
    )
    assert kept < now
    assert json.loads(saved(page, "JSON"))["trajectory"]["time"][-1] == pytest.approx(now, abs=1e-3)
    expect(page.locator("#stage")).to_have_attribute("data-ghosts", "other")
    page.get_by_role("button", name="End the comparison").click()
    expect(page.locator("#stage")).to_have_attribute("data-ghosts", "")
    expect(page.locator(".compare")).to_have_count(0)


def test_the_history_of_the_service_is_searched_and_opened(page: Page, made: ikplan.Plan) -> None:
    page.get_by_text("History of this service").click()
    rows = page.locator("#history-list .rows li")
    expect(rows.filter(has_text=made.id[:8])).to_have_count(1)
    page.get_by_role("searchbox", name="Search").fill("no such plan")
    expect(rows).to_have_count(0)
    page.get_by_role("searchbox", name="Search").fill(f"ur5 {made.id[:6]}")
    expect(rows).to_have_count(1)
    rows.get_by_role("button").click()
    expect(page.locator("#stale")).to_contain_text("from the history")
    expect(page.locator(".downloads code")).to_have_text(made.id[:16])
    seek(page, len(made.time) - 1)
    np.testing.assert_array_equal(ikplan.Plan.load(saved(page, "JSON")).q, made.q)
