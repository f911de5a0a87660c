"""Files dropped on the page: each is taken for what it is."""

from __future__ import annotations

import base64
import json
import struct
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from playwright.sync_api import Page, expect

from ikplan_api.routes.robots import _URDF as URDF

from .actions import EXAMPLES, document, example, open_tab, write

Open = Callable[..., Page]


@pytest.fixture(scope="module")
def page(visit: Open) -> Page:
    """The page of these tests."""
    return visit("helix_iiwa14", width=1280, height=800)


def drop(page: Page, name: str, content: bytes) -> None:
    """Drop a file on the page."""
    page.evaluate(
        """([name, content]) => {
            const bytes = Uint8Array.from(atob(content), c => c.charCodeAt(0));
            const data = new DataTransfer();
            data.items.add(new File([bytes], name));
            const told = { bubbles: true, cancelable: true, dataTransfer: data };
            document.body.dispatchEvent(new DragEvent('dragenter', told));
            document.body.dispatchEvent(new DragEvent('drop', told));
        }""",
        [name, base64.b64encode(content).decode()],
    )
    expect(page.locator("#drop")).to_be_hidden()


def stl(corners: list[tuple[float, ...]]) -> bytes:
    """A binary STL whose triangles have all these corners, shape (n, 3)."""
    triangles = [corners[i : i + 3] for i in range(len(corners) - 2)]
    rows = [struct.pack("<12fH", 0, 0, 0, *np.ravel(t), 0) for t in triangles]
    return bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows)


def test_a_request_is_opened(page: Page) -> None:
    drop(page, "lines.json", (EXAMPLES / "lines_panda.json").read_bytes())
    expect(page.locator("#told")).to_contain_text("lines.json is open")
    assert document(page) == example("lines_panda")
    page.get_by_role("button", name="Undo").click()
    assert document(page) == example("helix_iiwa14")


def test_points_are_read(page: Page) -> None:
    drop(page, "weld.csv", b"x;y;z\n500;-100;400,5\n500;100;400,5\n")
    expect(page.locator("#points-name")).to_have_text("weld.csv")
    expect(page.locator("#path-panel .rows li")).to_have_count(2)
    assert document(page)["path"]["waypoints"][1]["position"] == [0.5, 0.1, 0.4005]


def test_a_robot_is_uploaded_and_shown(page: Page) -> None:
    drop(page, "two.urdf", URDF.encode())
    expect(page.locator("#told")).to_contain_text("2 joints")
    name = document(page)["robot"]
    page.wait_for_selector(f"#stage[data-robot='{name}']")
    expect(page.locator("#robot")).to_have_value(name)
    drop(page, "broken.urdf", b"<robot name='x'/>")
    expect(page.locator("#told")).to_contain_text("broken.urdf")
    expect(page.locator("#told.bad")).to_be_visible()
    assert document(page)["robot"] == name


def test_a_shape_in_millimetres_becomes_an_obstacle_and_then_a_part(page: Page) -> None:
    write(page, example("helix_iiwa14"))
    corners = [tuple(100.0 * c for c in corner) for corner in product((0, 1), repeat=3)]
    inside = (50.0, 50.0, 50.0)
    drop(page, "block.stl", stl([*corners, inside]))
    expect(page.locator("#told")).to_contain_text("millimetres")
    (block,) = document(page)["scene"]["obstacles"]
    assert block["name"] == "block"
    assert sorted(block["shape"]["points"]) == [list(p) for p in product((0, 0.1), repeat=3)]
    open_tab(page, "scene")
    page.locator("#scene-panel .name", has_text="block").click()
    page.get_by_role("button", name="Let the tool carry it").click()
    scene = document(page)["scene"]
    assert scene["obstacles"] == []
    assert scene["attached"][0]["shape"] == block["shape"]
    page.get_by_role("button", name="Put it down here").click()
    (again,) = document(page)["scene"]["obstacles"]
    np.testing.assert_allclose(again["position"], [0, 0, 0], atol=2e-6)
    drop(page, "flat.stl", stl([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)]))
    expect(page.locator("#told.bad")).to_contain_text("fewer than four corners")


def test_a_scene_is_put_around_the_arm(page: Page) -> None:
    table = {"name": "table", "shape": {"type": "box", "size": [1, 1, 0.1]}, "position": [0, 0, -1]}
    drop(page, "cell.json", json.dumps({"name": "cell", "obstacles": [table]}).encode())
    expect(page.locator("#told")).to_contain_text("around the arm")
    assert document(page)["scene"] == {"obstacles": [table]}
