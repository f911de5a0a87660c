"""The page as a workbench: points placed, moved and planned by hand, as a user does it."""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Page, expect

import ikplan
from ikplan.plans.export import encode
from ikplan.robots import catalogue_robot

from .actions import document, drag_handle, open_tab, plan, saved, settled, tool, write

Open = Callable[..., Page]
UR5 = {
    "robot": "ur5",
    "start": [0.0, -1.4, 1.8, -1.97, -1.57, 0.0],
    "path": {"interpolation": "line", "waypoints": []},
}
"""An arm with its tool down, and no points yet."""
RISE = np.array([0.0, 0.0, 0.02])


@pytest.fixture(scope="module")
def page(visit: Open) -> Page:
    """The page of these tests, wide enough for all its parts."""
    return visit("helix_iiwa14", width=1280, height=800)


def begin(page: Page, request: dict[str, Any]) -> None:
    """Take up a document and wait for its arm."""
    write(page, request)
    page.wait_for_selector(f"#stage[data-robot={request['robot']}][data-meshes=ready]")
    open_tab(page, "path")


def joints(page: Page) -> list[float]:
    """The joint values that the sliders show."""
    cells = page.locator("#arm-panel .joint output")
    return [float(value) for value in cells.evaluate_all("all => all.map(c => c.dataset.value)")]


def positions(page: Page) -> list[list[float]]:
    path = document(page)["path"]
    return [point["position"] for point in path["waypoints"]]


def test_points_placed_with_the_mouse_are_followed_and_planned(page: Page) -> None:
    begin(page, UR5)
    for right, down in ((0, 0), (60, -20), (0, -60)):
        page.get_by_role("button", name="Add the current pose").click()
        if (right, down) != (0, 0):
            drag_handle(page, right, down)
            settled(page)
        expect(page.locator("#stage")).to_have_attribute("data-fault", "")
        np.testing.assert_allclose(tool(page), positions(page)[-1], atol=2e-6)
    placed = positions(page)
    assert len(placed) == 3
    assert all(np.linalg.norm(np.subtract(a, b)) > 0.02 for a, b in pairwise(placed))
    plan(page)
    expect(page.locator("#stale")).to_be_hidden()
    # What is changed makes the result that of another document, at once, and undoing it does not.
    drag_handle(page, 20, 0)
    expect(page.locator("#stale")).to_be_visible()
    page.get_by_role("button", name="Undo").click()
    expect(page.locator("#stale")).to_be_hidden()
    assert positions(page) == placed


def test_a_point_out_of_reach_makes_the_arm_red_and_says_why(page: Page) -> None:
    begin(page, UR5)
    page.get_by_role("button", name="Add the current pose").click()
    drag_handle(page, 600, -250)
    settled(page)
    expect(page.locator("#stage-note")).to_contain_text("unreachable")
    expect(page.locator("#stage-note")).to_contain_text("out of reach")
    page.get_by_role("button", name="Undo").click()
    page.click("#arm-tab")
    page.get_by_role("button", name="Home").click()
    settled(page)
    expect(page.locator("#stage")).to_have_attribute("data-fault", "")


def test_a_pose_in_an_obstacle_makes_the_arm_red_and_names_the_bodies(page: Page) -> None:
    begin(page, UR5)
    page.get_by_role("button", name="Add the current pose").click()
    at = positions(page)[0]
    page.click("#scene-tab")
    page.get_by_role("button", name="Add a sphere").click()
    for axis, value in zip("xyz", at, strict=True):
        page.get_by_role("spinbutton", name=f"Position {axis}").fill(str(value))
        page.keyboard.press("Tab")
    (ball,) = document(page)["scene"]["obstacles"]
    assert ball["position"] == at
    assert ball["shape"] == {"type": "sphere", "radius": 0.1}
    page.click("#path-tab")
    page.locator("#path-panel .name").first.click()
    drag_handle(page, 10, 0)
    settled(page)
    expect(page.locator("#stage-note")).to_contain_text("sphere")
    page.click("#plan")
    expect(page.locator("#result .verdict")).to_contain_text("sphere")


def test_the_list_inserts_copies_orders_types_and_limits_points(page: Page) -> None:
    points = [{"position": [0.4, 0.1 * i, 0.3]} for i in range(3)]
    begin(page, {**UR5, "path": {"interpolation": "line", "waypoints": points}})
    row = page.locator("#path-panel .rows li")
    expect(row).to_have_count(3)

    def press(name: str) -> None:
        page.get_by_role("button", name=name, exact=True).click()

    press("Duplicate point 1")
    press("Move point 2 up")
    press("Delete point 3")
    assert positions(page) == [[0.4, 0.0, 0.3], [0.4, 0.1, 0.3], [0.4, 0.1, 0.3]]
    page.locator("#path-panel .name").nth(1).click()
    page.get_by_role("spinbutton", name="Position z").fill("0.35")
    page.keyboard.press("Tab")
    page.get_by_role("combobox", name="Type of point 2").select_option("joint")
    page.locator("#path-panel .name").nth(1).click()
    page.get_by_role("spinbutton", name="Blend").fill("0.01")
    page.keyboard.press("Tab")
    page.get_by_role("spinbutton", name="Velocity scale").fill("0.5")
    page.keyboard.press("Tab")
    page.click("[data-unit=mm]")
    page.get_by_role("spinbutton", name="Tool speed").fill("80")
    page.keyboard.press("Tab")
    page.click("[data-unit=m]")
    press("Insert before")
    segments = document(page)["path"]["segments"]
    assert [segment["type"] for segment in segments] == ["line", "line", "line", "joint"]
    assert segments[2] == {
        "type": "line",
        "to": {"position": [0.4, 0.1, 0.35]},
        "blend": 0.01,
        "limits": {"velocity_scale": 0.5, "tool_speed": {"linear": 0.08}},
    }
    np.testing.assert_allclose(segments[1]["to"]["position"], tool(page), atol=2e-6)


def test_ten_steps_are_undone_and_redone_and_kept_over_a_reload(page: Page) -> None:
    begin(page, UR5)
    states = [document(page)]
    for _ in range(10):
        page.get_by_role("button", name="Add the current pose").click()
        states.append(document(page))
    for state in reversed(states[5:-1]):
        page.locator("body").press("Control+z")
        assert document(page) == state
    page.wait_for_timeout(300)
    page.reload()
    page.wait_for_selector("#stage[data-robot=ur5][data-meshes=ready]")
    assert document(page) == states[5]
    for state in reversed(states[:5]):
        page.get_by_role("button", name="Undo").click()
        assert document(page) == state
    for state in states[1:]:
        page.locator("body").press("Control+Shift+z")
        assert document(page) == state
    expect(page.get_by_role("button", name="Redo")).to_be_disabled()


def test_a_link_opens_the_same_request(page: Page, visit: Open) -> None:
    begin(page, UR5)
    page.get_by_role("button", name="Add the current pose").click()
    page.get_by_role("button", name="Link").click()
    page.wait_for_function("() => location.hash.startsWith('#request=')")
    linked = visit(page.evaluate("() => location.hash.slice(1)"))
    assert document(linked) == document(page)


def test_joints_and_tool_are_jogged_as_pinocchio_has_it(page: Page) -> None:
    begin(page, UR5)
    open_tab(page, "arm")
    robot = catalogue_robot("ur5")
    page.get_by_role("button", name="elbow_joint on").click()
    settled(page)
    wanted = np.array(UR5["start"]) + np.radians([0, 0, 5, 0, 0, 0])
    np.testing.assert_allclose(joints(page), wanted, atol=1e-9)
    np.testing.assert_allclose(tool(page), robot.fk(wanted).translation, atol=1e-6)
    before = robot.fk(wanted)
    page.get_by_role("button", name="Jog z on").click()
    page.get_by_role("button", name="Jog z on").click()
    settled(page)
    np.testing.assert_allclose(tool(page), before.translation + RISE, atol=1e-5)
    page.get_by_role("combobox", name="Axes of the jog").select_option("tool")
    page.get_by_role("button", name="Jog x back").click()
    settled(page)
    expected = before.translation + RISE - 0.01 * before.rotation[:, 0]
    np.testing.assert_allclose(tool(page), expected, atol=1e-5)
    page.get_by_role("button", name="Jog rz on").click()
    settled(page)
    turned = robot.fk(joints(page)).rotation
    angle = np.arccos((np.trace(before.rotation.T @ turned) - 1) / 2)
    assert np.degrees(angle) == pytest.approx(5, abs=1e-2)
    page.get_by_role("button", name="Start the path here").click()
    np.testing.assert_allclose(document(page)["start"], joints(page))


def test_a_path_is_blocked_cleared_compared_taken_home_and_played(page: Page) -> None:
    begin(page, UR5)
    for right, down in ((0, 0), (60, -20), (0, -60)):
        page.get_by_role("button", name="Add the current pose").click()
        if (right, down) != (0, 0):
            drag_handle(page, right, down)
            settled(page)
    plan(page)
    page.get_by_role("button", name="Keep to compare").click()
    # An obstacle where the second point is: there is no plan, and the verdict names it.
    open_tab(page, "scene")
    page.get_by_role("button", name="Add a sphere").click()
    for axis, value in zip("xyz", positions(page)[1], strict=True):
        page.get_by_role("spinbutton", name=f"Position {axis}").fill(str(value))
        page.keyboard.press("Tab")
    page.click("#plan")
    expect(page.locator("#result .verdict")).to_contain_text("sphere")
    # It is dragged away, and there is a plan again.
    drag_handle(page, 40, -260)
    expect(page.locator("#stale")).to_be_visible()
    plan(page)
    expect(page.locator("#stale")).to_be_hidden()
    expect(page.locator(".compare table")).to_contain_text("Arm from obstacles")
    made = ikplan.Plan.load(saved(page, "JSON"))
    assert saved(page, "urscript").encode() == encode(made, "urscript")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function(
        "end => Number(document.getElementById('clock').dataset.value) >= end",
        arg=float(made.time[-1]),
    )
    np.testing.assert_array_equal(joints(page), made.q[-1])
    page.get_by_role("button", name="End the comparison").click()
