"""The viewer of one plan, as a notebook shows it and as a file."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Frame, Page

import ikplan
from ikplan import InvalidRequest, Plan
from ikplan_api.routes.page import BUNDLE_HINT, bundle_folder

from .browser import missing

HALF = "e => { e.value = Math.floor(e.max / 2); e.dispatchEvent(new Event('input')); }"
SCENE: dict[str, Any] = {
    "obstacles": [
        {
            "name": "post",
            "shape": {"type": "box", "size": [0.1, 0.1, 0.4]},
            "position": [0.0, 0.9, 0.2],
        }
    ]
}


@pytest.fixture(scope="module")
def plan() -> Plan:
    if not (bundle_folder() / "embed.html").is_file():
        missing(f"there is no page; {BUNDLE_HINT} makes it")
    robot = ikplan.load_robot("ur5")
    return ikplan.time_path(robot, robot.home + np.array([[0.0] * 6, [0.3] * 6, [0.7] * 6]))


@pytest.fixture
def blank(browser: Browser) -> Iterator[Page]:
    context = browser.new_context(viewport={"width": 800, "height": 500})
    page = context.new_page()
    faults: list[str] = []
    asked: list[str] = []
    page.on("console", lambda m: faults.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: faults.append(str(error)))
    page.on("request", lambda r: asked.append(r.url) if not r.url.startswith("file:") else None)
    yield page
    context.close()
    assert faults == []
    assert asked == []


def moment(frame: Frame) -> np.ndarray[Any, Any]:
    frame.wait_for_selector("body[data-meshes=ready]")
    frame.locator("#time").evaluate(HALF)
    told = frame.locator("#stage").get_attribute("data-tool")
    assert told is not None
    return np.array([float(word) for word in told.split()])


def half_way(plan: Plan) -> np.ndarray[Any, Any]:
    q = plan.q[(len(plan.time) - 1) // 2]
    return np.array(ikplan.load_robot("ur5").fk(q).translation)


def test_a_notebook_shows_the_arm_where_the_plan_has_it(plan: Plan, blank: Page) -> None:
    viewer = plan.show(SCENE, height=300)
    blank.set_content(viewer._repr_html_())
    frame = blank.frames[1]
    assert np.abs(moment(frame) - half_way(plan)).max() <= 1e-6
    assert f"of {plan.duration:.3f} s" in frame.locator("#clock").inner_text()
    box = blank.locator("iframe").bounding_box()
    assert box is not None
    assert box["height"] == 300


def test_a_file_plays(plan: Plan, blank: Page, tmp_path: Path) -> None:
    plan.show(meshes=False).save(tmp_path / "plan.html")
    blank.goto((tmp_path / "plan.html").as_uri())
    assert np.abs(moment(blank.main_frame) - half_way(plan)).max() <= 1e-6
    blank.locator("#play").click()
    blank.wait_for_function(
        "+document.getElementById('time').value == document.getElementById('time').max"
    )


def test_a_tool_moves_what_is_drawn(plan: Plan, blank: Page, tmp_path: Path) -> None:
    tool = {"position": [0.0, 0.0, 0.25]}
    plan.show(tool=tool, meshes=False).save(tmp_path / "plan.html")
    blank.goto((tmp_path / "plan.html").as_uri())
    robot = ikplan.load_robot("ur5")
    T = robot.fk(plan.q[(len(plan.time) - 1) // 2])
    wanted = T.translation + T.rotation @ tool["position"]
    assert np.abs(moment(blank.main_frame) - wanted).max() <= 1e-6


def test_no_name_ends_the_script(plan: Plan, blank: Page, tmp_path: Path) -> None:
    named = {"obstacles": [{**SCENE["obstacles"][0], "name": "</script><h1>out</h1>"}]}
    plan.show(named, meshes=False).save(tmp_path / "plan.html")
    blank.goto((tmp_path / "plan.html").as_uri())
    moment(blank.main_frame)
    assert blank.locator("h1").count() == 0


def test_another_robot_is_refused(plan: Plan) -> None:
    with pytest.raises(InvalidRequest, match="the plan is for 'ur5'"):
        plan.show(robot=ikplan.load_robot("ur10"))


def test_the_line_that_stands_for_it_is_short(plan: Plan) -> None:
    assert len(repr(plan.show(meshes=False))) < 100
