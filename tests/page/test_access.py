"""The page for everyone: keyboard and screen readers, narrow windows, little time, few bytes."""

from __future__ import annotations

import gzip
import os
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from ikplan_api.routes.page import bundle_folder

from .actions import example, open_tab, plan, write
from .browser import REQUIRED, Visit

Open = Callable[..., Page]
AXE = Path(__file__).parents[2] / "web/node_modules/axe-core/axe.min.js"
MOST_COMPRESSED = 1.5e6
"""Bytes of the bundle, compressed."""


@pytest.fixture(scope="module", params=["light", "dark"])
def page(request: pytest.FixtureRequest, visit: Open) -> Page:
    """The page with a plan, in light and dark surroundings."""
    opened = visit("lines_panda", width=1280, height=800, dark=request.param == "dark")
    plan(opened)
    return opened


def serious(page: Page) -> list[str]:
    """What axe finds serious or critical."""
    if not AXE.is_file():
        if os.environ.get(REQUIRED) == "required":
            pytest.fail("axe-core is not installed; make page installs it")
        pytest.skip("axe-core is not installed")
    page.evaluate(AXE.read_text())
    found = page.evaluate(
        "async () => (await axe.run()).violations"
        ".filter(v => v.impact === 'serious' || v.impact === 'critical')"
        ".map(v => `${v.id}: ${v.nodes.map(n => n.html).join('; ').slice(0, 400)}`)"
    )
    return [str(entry) for entry in found]


def test_axe_finds_nothing_serious_in_any_part(page: Page) -> None:
    found: dict[str, list[str]] = {}
    for tab in ("path", "scene", "arm", "document"):
        open_tab(page, tab)
        if tab == "path":
            page.locator("#path-panel .name").nth(1).click()
        if tab == "scene":
            page.get_by_role("button", name="Add a box").click()
        found[tab] = serious(page)
    assert {tab: faults for tab, faults in found.items() if faults} == {}


def test_tabs_are_walked_by_the_arrow_keys(page: Page) -> None:
    open_tab(page, "path")
    page.focus("#path-tab")
    for name in ("scene", "arm", "document", "path"):
        page.keyboard.press("ArrowRight")
        expect(page.locator(f"#{name}-tab")).to_be_focused()
        expect(page.locator(f"#{name}-panel")).to_be_visible()


def test_a_point_is_placed_by_the_keyboard_alone(visit: Open) -> None:
    page = visit("lines_panda")
    page.focus("#path-tab")
    page.keyboard.press("Tab")
    for _ in range(60):
        focused = page.evaluate("() => document.activeElement.textContent")
        if focused == "Add the current pose":
            break
        page.keyboard.press("Tab")
    page.keyboard.press("Enter")
    expect(page.locator("#path-panel .rows li")).to_have_count(6)
    # The focus stays where it was, though the list is drawn anew.
    assert page.evaluate("() => document.activeElement.textContent") == "Add the current pose"


@pytest.mark.parametrize("tab", ["path", "scene", "arm", "document"])
def test_no_part_hangs_over_the_edge_of_a_phone(visit: Open, tab: str) -> None:
    page = visit("lines_panda", width=390, height=844)
    open_tab(page, tab)
    if tab == "path":
        page.locator("#path-panel .name").nth(1).click()
    for width in (390, 320, 820):
        page.set_viewport_size({"width": width, "height": 844})
        assert page.evaluate("() => document.documentElement.scrollWidth <= innerWidth"), width


def test_the_bundle_is_small_and_painted_soon(address: str, browser: Browser) -> None:
    size = sum(
        len(gzip.compress(file.read_bytes()))
        for file in bundle_folder().iterdir()
        if file.suffix in (".js", ".css", ".html")
    )
    assert size < MOST_COMPRESSED
    visit = Visit(browser, address, width=1280, height=800, dark=False)
    page = visit.open("helix_iiwa14")
    painted = page.evaluate(
        "() => performance.getEntriesByName('first-contentful-paint')[0].startTime"
    )
    # A second on a machine that is free; this one may be shared by many.
    assert painted < 1000 * max(1.0, os.getloadavg()[0])
    visit.close()


def test_a_field_that_the_schema_does_not_know_is_marked_and_names_are_completed(
    visit: Open,
) -> None:
    page = visit("helix_iiwa14", width=1280, height=800)
    request = example("helix_iiwa14")
    write(page, {**request, "speed": 1, "budget_s": -1})
    marked = page.locator("#editor .cm-lintRange-error")
    expect(marked).to_have_count(2, timeout=30_000)  # the schema is read first
    expect(marked.first).to_have_text("1")
    write(page, request)
    expect(marked).to_have_count(0)
    page.locator("#editor .cm-content").press("Control+Home")
    page.keyboard.press("ArrowRight")
    page.keyboard.type('"bud')
    option = page.locator("#editor .cm-tooltip-autocomplete li", has_text="budget_s")
    expect(option).to_be_visible()
    page.wait_for_timeout(300)  # the list takes no key in its first 75 ms: nobody has read it yet
    page.keyboard.press("Enter")
    expect(page.locator("#editor .cm-content")).to_contain_text('"budget_s": ')
