"""The page in a browser: what it shows is what was planned."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import time
import urllib.parse
from collections.abc import Callable
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from playwright.sync_api import Browser, Page, expect

import ikplan
from benchmarks.requests.robots import REFERENCE_ROBOTS
from ikplan.client.api_keys import key_hash, new_key
from ikplan.plans.export import encode
from ikplan.robots import Robot, catalogue_robot
from ikplan_api.settings import Settings

from .actions import (
    EXAMPLES,
    document,
    example,
    open_tab,
    plan,
    saved,
    seek,
    tool,
    type_text,
    write,
)
from .browser import NoPlanner, Visit, served

# A worker may have to compile what a request uses.
expect.set_options(timeout=120_000)
RED = (0xC6, 0x2A, 0x1F)
"""Of what failed, in light surroundings."""
DARK = (0x17, 0x1B, 0x1F)
"""Behind the scene, in dark ones."""
VECTORS = Path(__file__).parents[1] / "vectors" / "planning"
Open = Callable[..., Page]


@pytest.fixture(scope="module")
def helix(visit: Open) -> Page:
    """The page with the plan of the helix: each test leaves it as it was."""
    page = visit("helix_iiwa14")
    plan(page)
    return page


@pytest.fixture(scope="module")
def made() -> ikplan.Plan:
    """The same plan by the library."""
    return ikplan.plan(example("helix_iiwa14"))


def shown(page: Page, kind: str) -> NDArray[np.float64]:
    """Joint values as the page has them, shape (dof,)."""
    cells = page.locator(f"output[data-kind={kind}]")
    return np.array(cells.evaluate_all("cells => cells.map(c => Number(c.dataset.value))"))


def clock(page: Page) -> float:
    return float(page.locator("#clock").get_attribute("data-value") or "nan")


def picture(page: Page) -> NDArray[np.int64]:
    """The 3D view as pixels, shape (height, width, 3)."""
    image = Image.open(io.BytesIO(page.locator("#stage canvas").screenshot()))
    return np.asarray(image.convert("RGB"), dtype=np.int64)


def near_colour(page: Page, colour: tuple[int, int, int]) -> int:
    """How many pixels of the 3D view have nearly that colour."""
    return int((np.abs(picture(page) - colour).max(axis=2) < 12).sum())


def between(pixels: NDArray[np.int64], low: int, high: int) -> int:
    """How many pixels have all their colours between two values."""
    return int(((pixels.min(axis=2) > low) & (pixels.max(axis=2) < high)).sum())


def drawn(true: Callable[[], bool]) -> bool:
    """Whether something is true within a while: the next picture may take long to be drawn."""
    deadline = time.monotonic() + 120
    while not true():
        if time.monotonic() > deadline:
            return False
        time.sleep(0.1)
    return True


def check_samples(page: Page, made: ikplan.Plan, robot: Robot) -> None:
    last = len(made.time) - 1
    assert page.get_attribute("#time", "max") == str(last)
    for index in (last // 3, last // 2, last, 0):
        seek(page, index)
        assert clock(page) == made.time[index]
        for kind, rows in (("q", made.q), ("dq", made.dq), ("ddq", made.ddq)):
            np.testing.assert_array_equal(shown(page, kind), rows[index])
        np.testing.assert_allclose(tool(page), robot.fk(made.q[index]).translation, atol=1e-6)


def test_what_is_shown_at_a_time_is_what_was_planned(helix: Page, made: ikplan.Plan) -> None:
    check_samples(helix, made, catalogue_robot("iiwa14"))


def test_the_tool_of_the_request_is_the_one_that_is_shown(visit: Open) -> None:
    request = example("curve_ur5")
    page = visit("curve_ur5")
    plan(page)
    robot = catalogue_robot("ur5").with_tool(request["tool"]["position"])
    made = ikplan.plan(request)
    check_samples(page, made, robot)
    (segment,) = made.certificate.segments
    used = {
        "Joint velocities": made.certificate.velocity_limit_ratio,
        "Joint accelerations": made.certificate.acceleration_limit_ratio,
        "Joint jerks": made.certificate.jerk_limit_ratio,
        "Own limits of segments[1]": segment.tool_speed_ratio,
    }
    for promise, ratio in used.items():
        assert ratio is not None
        row = page.locator(".certificate tr", has=page.get_by_role("rowheader", name=promise))
        expect(row).to_contain_text(f"{math.ceil(ratio * 1000 - 1e-6) / 10:.1f} %")


def test_between_samples_the_motion_is_the_librarys(helix: Page, made: ikplan.Plan) -> None:
    chart = helix.locator(".chart .u-over").first
    box = chart.bounding_box()
    assert box is not None
    chart.click(position={"x": box["width"] * 0.377, "y": 10})
    t = clock(helix)
    assert t == pytest.approx(0.377 * made.duration, rel=0.02)
    assert t not in made.time
    q, dq, ddq = made.at(t)
    np.testing.assert_allclose(shown(helix, "q"), q, atol=1e-9)
    np.testing.assert_allclose(shown(helix, "dq"), dq, atol=1e-9)
    np.testing.assert_allclose(shown(helix, "ddq"), ddq, atol=1e-6)


def test_the_keyboard_moves_and_runs_the_time(helix: Page, made: ikplan.Plan) -> None:
    helix.focus("#time")
    for key, index in (("End", len(made.time) - 1), ("Home", 0), ("ArrowRight", 1)):
        helix.keyboard.press(key)
        np.testing.assert_array_equal(shown(helix, "q"), made.q[index])
    helix.keyboard.press("Space")
    expect(helix.locator("#play")).to_have_text("Pause")
    helix.wait_for_function("() => Number(document.getElementById('clock').dataset.value) > 0.05")
    helix.keyboard.press("Space")
    expect(helix.locator("#play")).to_have_text("Play")
    np.testing.assert_allclose(shown(helix, "q"), made.at(clock(helix))[0], atol=1e-9)
    seek(helix, 0)


def test_angles_are_shown_in_the_unit_chosen(helix: Page, made: ikplan.Plan) -> None:
    cell = helix.locator("output[data-kind=q]").nth(1)
    helix.click("[data-unit=rad]")
    expect(cell).to_have_text(f"{made.q[0, 1]:.3f}")
    expect(helix.locator(".plot-head")).to_contain_text("rad/s²")
    helix.click("[data-unit=deg]")
    expect(cell).to_have_text(f"{np.degrees(made.q[0, 1]):.2f}")


def test_downloads_hold_the_plan(helix: Page, made: ikplan.Plan) -> None:
    assert encode(ikplan.Plan.load(saved(helix, "JSON")), "npz") == encode(made, "npz")
    ours = list(csv.reader(io.StringIO(encode(made, "csv").decode())))
    theirs = list(csv.reader(io.StringIO(saved(helix, "CSV"))))
    assert theirs[0] == ours[0]
    np.testing.assert_array_equal(np.array(theirs[1:], float), np.array(ours[1:], float))


def test_every_control_has_a_name_and_a_visible_focus(helix: Page) -> None:
    unnamed = helix.locator("button, select, input:not([hidden]), textarea").evaluate_all(
        "all => all.filter(e => !(e.tagName === 'BUTTON' && e.textContent.trim())"
        " && !e.getAttribute('aria-label') && !(e.labels && e.labels.length))"
        ".map(e => e.outerHTML)"
    )
    assert unnamed == []
    helix.focus("#robot")
    helix.keyboard.press("Tab")
    outline = "() => getComputedStyle(document.activeElement).outlineStyle"
    assert helix.evaluate(outline) == "solid"


def test_nothing_hangs_over_the_edge_of_any_window(helix: Page) -> None:
    before = helix.viewport_size
    assert before is not None
    for width in (320, 390, 768, 1024, 1440):
        helix.set_viewport_size({"width": width, "height": 640})
        assert helix.evaluate("() => document.documentElement.scrollWidth <= innerWidth"), width
        outside = helix.locator("button, select, input:not([hidden]), td, svg").evaluate_all(
            "all => all.filter(e => { const b = e.getBoundingClientRect();"
            " return b.left < 0 || b.right > innerWidth; }).map(e => e.outerHTML)"
        )
        assert outside == [], width
    helix.set_viewport_size(before)


def test_every_robot_stands_in_the_scene_as_pinocchio_has_it(visit: Open) -> None:
    page = visit()
    for name in REFERENCE_ROBOTS:
        robot = catalogue_robot(name)
        page.select_option("#robot", name)
        try:
            page.wait_for_function(
                "([p]) => [...document.querySelectorAll('#tool dd')]"
                ".every((c, i) => Math.abs(Number(c.dataset.value) - p[i]) < 1e-6)",
                arg=[robot.fk(robot.home).translation.tolist()],
            )
        except Exception as error:
            raise AssertionError(f"{name}: {tool(page)}") from error
        assert document(page)["robot"] == name


def test_meshes_come_from_the_service_and_are_drawn(visit: Open) -> None:
    page = visit("beyond_reach_xarm7", meshes=True)
    expect(page.locator("#stage-note")).to_have_text("")
    sizes = page.evaluate(
        "() => performance.getEntriesByType('resource')"
        ".filter(e => e.name.includes('/v1/robots/xarm7/meshes/')).map(e => e.decodedBodySize)"
    )
    assert len(sizes) == 8
    assert min(sizes) > 100_000
    # An arm casts shades on itself (empty: some 300 such pixels); this one's meshes are white,
    # while the drums of a skeleton are dark (some 2200 pixels).
    assert drawn(lambda: between(picture(page), 100, 185) > 800)
    assert between(picture(page), -1, 90) < 1000


def test_a_refusal_is_told_drawn_and_repaired(visit: Open) -> None:
    request = example("beyond_reach_xarm7")
    with pytest.raises(ikplan.Unreachable) as caught:
        ikplan.plan(request)
    error = caught.value
    page = visit("beyond_reach_xarm7")
    before = near_colour(page, RED)
    page.click("#plan")
    card = page.locator("#result .verdict")
    card.wait_for()
    assert error.title in card.inner_text()
    assert error.reason in card.inner_text()
    closest = catalogue_robot("xarm7").fk(error.q).translation
    np.testing.assert_allclose(tool(page), closest, atol=1e-6)
    assert drawn(lambda: near_colour(page, RED) > before + 100)
    card.get_by_role("button", name="Apply and plan").first.click()
    page.wait_for_selector("#result .certificate")
    repaired = document(page)
    change = error.repairs[0]["change"]["path"]
    assert {key: repaired["path"][key] for key in change} == change
    assert repaired["path"]["waypoints"] == request["path"]["waypoints"]


DOWN = [1.0, 0.0, 0.0, 0.0]
CURVES = {
    "arc": {"type": "arc", "centre": [0.5, 0.35, 0.3], "angle": 6.0},
    "circle": {"type": "circle", "radius": 0.5, "quaternion_xyzw": DOWN},
    "helix": {"type": "helix", "radius": 0.1, "rise": 1.5, "turns": 2, "quaternion_xyzw": DOWN},
}


@pytest.mark.parametrize("kind", CURVES)
def test_where_a_curve_cannot_be_followed_is_drawn(visit: Open, kind: str) -> None:
    path: dict[str, Any] = {"segments": [CURVES[kind]]}
    if kind == "arc":
        path["begin"] = {"position": [0.5, -0.3, 0.3], "quaternion_xyzw": DOWN}
    else:
        path["frame"] = {"position": [0.5, 0.0, 0.2]}
    request = {"robot": "ur5", "start": "free", "path": path}
    with pytest.raises((ikplan.Unreachable, ikplan.Disconnected)) as caught:
        ikplan.plan(request)
    page = visit("helix_iiwa14")
    write(page, request)
    page.wait_for_selector("#stage[data-robot=ur5][data-meshes=ready]")
    before = near_colour(page, RED)
    page.click("#plan")
    expect(page.locator("#result .verdict")).to_contain_text("Shown: ")
    assert isinstance(caught.value, ikplan.Unreachable | ikplan.Disconnected)
    place = catalogue_robot("ur5").fk(caught.value.q).translation
    np.testing.assert_allclose(tool(page), place, atol=1e-6)
    assert drawn(lambda: near_colour(page, RED) > before + 100)


def test_an_arm_that_gets_no_further_is_shown_where_it_stands(visit: Open) -> None:
    vector = json.loads((VECTORS / "ur5_wrist_turns_to_its_limit.json").read_text())
    with pytest.raises(ikplan.Disconnected) as caught:
        ikplan.plan(vector["request"])
    page = visit("helix_iiwa14")
    write(page, vector["request"])
    page.wait_for_selector(f"#stage[data-robot={vector['request']['robot']}][data-meshes=ready]")
    page.click("#plan")
    expect(page.locator("#result .verdict")).to_contain_text("the arm where it gets no further")
    robot = catalogue_robot(vector["request"]["robot"])
    np.testing.assert_allclose(tool(page), robot.fk(caught.value.q).translation, atol=1e-6)
    assert drawn(lambda: near_colour(page, RED) > 100)


def slow(seed: int) -> dict[str, Any]:
    """A request whose search takes a while."""
    return {
        "robot": "iiwa14",
        "path": {"waypoints": [{"position": [0.5, 0.01 * i, 0.5]} for i in range(50)]},
        "ik": {"population": 1000, "iterations": 1000, "seed": seed},
        "budget_s": 100,
    }


def job_of(page: Page) -> str:
    """Where the job is that the page asks for when its button is pressed."""
    with page.expect_response(lambda r: r.url.endswith("/v1/plans")) as caught:
        page.click("#plan")
    assert caught.value.status == 202
    return urllib.parse.urljoin(caught.value.url, caught.value.headers["location"])


def gone(place: str) -> bool:
    return httpx.get(place).status_code == 404


@pytest.mark.parametrize("how", ["button", "Escape", "leaving"])
def test_the_progress_of_a_plan_is_shown_and_it_can_be_given_up(visit: Open, how: str) -> None:
    page = visit("helix_iiwa14")
    write(page, slow(len(how)))
    place = job_of(page)
    text = page.locator("#progress-text")
    expect(text).to_have_text(re.compile(r"Joint solutions: [1-9]\d* of 50 waypoints"))
    bar = page.locator("#progress-bar")
    assert 1 <= bar.evaluate("bar => bar.value") <= 50
    assert bar.evaluate("bar => bar.max") == 50
    expect(page.locator("#status")).to_have_text("Joint solutions")
    expect(page.locator("#plan")).to_have_text("Cancel")
    if how == "leaving":
        page.goto("about:blank")
    else:
        page.click("#plan") if how == "button" else page.keyboard.press("Escape")
        expect(page.locator("#progress")).to_be_hidden()
        expect(page.locator("#plan")).to_have_text("Plan")
        expect(page.locator("#status")).to_have_text("Cancelled")
    assert drawn(lambda: gone(place))


def test_a_plan_comes_also_where_events_do_not_get_through(visit: Open) -> None:
    page = visit("helix_iiwa14")
    page.route("**/events", lambda route: route.fulfill(status=404, body=""))
    request = slow(7)
    request["path"]["waypoints"] = request["path"]["waypoints"][:4]
    write(page, request)
    job_of(page)
    expect(page.locator("#progress-text")).to_contain_text("of 4 waypoints")
    page.wait_for_selector("#result .certificate")
    expect(page.locator("#progress")).to_be_hidden()


def test_two_waypoints_without_a_way_between_them_are_drawn(visit: Open) -> None:
    page = visit("helix_iiwa14")
    problem = ikplan.Disconnected("no way", waypoints=[4, 5], jump=1.0).to_problem()
    page.route(
        "**/v1/plans",
        lambda route: route.fulfill(
            status=422, content_type="application/problem+json", body=json.dumps(problem)
        ),
    )
    before = near_colour(page, RED)
    page.click("#plan")
    expect(page.locator("#result .verdict")).to_contain_text("No way.")
    expect(page.locator("#result .verdict")).to_contain_text("No repair was found")
    assert drawn(lambda: near_colour(page, RED) > before + 100)


def test_a_wrong_field_and_a_wrong_document_are_told(visit: Open) -> None:
    page = visit("helix_iiwa14")
    type_text(page, '{"robot": "iiwa14"')
    expect(page.locator("#fault")).to_contain_text("Not JSON")
    type_text(page, '{"robot": "iiwa14", "speed": 1, "path": {"waypoints": []}}')
    expect(page.locator("#fault")).to_have_text("")
    page.click("#plan")
    expect(page.locator("#result .verdict")).to_contain_text("speed")


def test_a_file_of_points_is_read_planned_and_asked_about(visit: Open, tmp_path: Path) -> None:
    page = visit("helix_iiwa14")
    expect(page.locator("#points")).to_be_hidden()
    page.select_option("#robot", "ur5")
    points = tmp_path / "weld.csv"
    points.write_text("x;y;z;A;B;C\n400;-100;300,5;0;0;180\n400;100;300,5;0;0;180\n")
    page.set_input_files("#file", points)
    expect(page.locator("#points-name")).to_have_text("weld.csv")
    expect(page.locator("#points-notes")).to_contain_text("lengths read as millimetres")
    expect(page.locator("#points-notes")).to_contain_text("KUKA")
    page.select_option("#points-interpolation", "line")
    expect(page.get_by_role("combobox", name="Type of point 0")).to_have_value("line")
    request = document(page)
    assert request["robot"] == "ur5"
    assert request["path"]["waypoints"] == ikplan.read_waypoints(points)
    plan(page)
    # What may mean two things is asked, and the answer is used.
    points.write_text("4,0,3,0,0,0,1\n")
    page.set_input_files("#file", points)
    expect(page.locator("#points-notes .fault")).to_contain_text("no header")
    expect(page.locator("#points-columns")).to_have_attribute("aria-invalid", "true")
    page.fill("#points-columns", "x,y,z,qx,qy,qz,qw")
    page.keyboard.press("Tab")
    expect(page.locator("#points-notes .fault")).to_contain_text("metres or millimetres")
    page.select_option("#points-units", "cm")
    expect(page.locator("#points-notes")).to_contain_text("unit quaternion")
    read = document(page)["path"]["waypoints"]
    assert read == [{"position": [0.04, 0, 0.03], "quaternion_xyzw": [0, 0, 0, 1]}]
    # Joints have the names of the robot that is chosen.
    ur5 = catalogue_robot("ur5")
    points.write_text(",".join(reversed(ur5.joint_names)) + "\n0,0.1,0.2,0.3,0.4,0.5\n")
    page.select_option("#robot", "panda")
    page.set_input_files("#file", points)
    expect(page.locator("#points-notes .fault")).to_contain_text("x, y, z is missing")
    page.select_option("#robot", "ur5")
    expect(page.locator("#points-notes")).to_contain_text("read as joint values")
    segments = document(page)["path"]["segments"]
    assert [segment["q"] for segment in segments] == [[0.5, 0.4, 0.3, 0.2, 0.1, 0]]
    page.set_input_files("#file", EXAMPLES / "helix_iiwa14.json")
    expect(page.locator("#points")).to_be_hidden()
    assert document(page) == example("helix_iiwa14")


def test_by_keyboard_alone_in_the_dark(visit: Open) -> None:
    page = visit("helix_iiwa14", dark=True)
    background = page.evaluate("() => getComputedStyle(document.body).backgroundColor")
    assert background == "rgb(17, 20, 23)"
    open_tab(page, "document")
    page.locator("#editor .cm-content").focus()
    page.keyboard.press("Control+Enter")
    page.wait_for_selector("#result .certificate")
    assert drawn(lambda: near_colour(page, DARK) > 1000)


def test_a_key_is_asked_for_where_one_is_needed(browser: Browser) -> None:
    key = new_key()
    settings = Settings.model_validate({"api_keys": key_hash(key)})
    with served(settings, NoPlanner()) as address:
        visit = Visit(browser, address, width=760, height=560, dark=False)
        page = visit.page
        page.goto(address)
        # The second panel tells something else than the first: what is filled in is for it.
        for said, given in (("An API key is required", "ikp_wrong"), ("Invalid API key", key)):
            expect(page.locator("#result")).to_contain_text(said)
            page.get_by_label("API key").fill(given)
            page.keyboard.press("Enter")
        # Robots, their shapes and meshes come with the key.
        page.select_option("#robot", "xarm7")
        page.wait_for_selector("#stage[data-robot=xarm7][data-meshes=ready]")
        expect(page.locator("#stage-note")).to_have_text("")
        home = catalogue_robot("xarm7")
        np.testing.assert_allclose(tool(page), home.fk(home.home).translation, atol=1e-6)
        visit.close()
