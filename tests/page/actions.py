"""What a user does in the page: write, plan, drag, read."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from playwright.sync_api import Page, expect

__all__ = [
    "EXAMPLES",
    "document",
    "drag_handle",
    "example",
    "open_tab",
    "plan",
    "saved",
    "seek",
    "settled",
    "tool",
    "type_text",
    "write",
]

EXAMPLES = Path(__file__).parents[2] / "examples"


def example(name: str) -> dict[str, Any]:
    """An example of the checkout."""
    read: dict[str, Any] = json.loads((EXAMPLES / f"{name}.json").read_text())
    return read


def open_tab(page: Page, name: str) -> None:
    """Show a part of the request: path, scene, arm or document."""
    page.click(f"#{name}-tab")


def type_text(page: Page, text: str) -> None:
    """Replace the text of the document in the editor."""
    open_tab(page, "document")
    page.locator("#editor .cm-content").focus()
    page.keyboard.press("Control+A")
    page.keyboard.insert_text(text)


def write(page: Page, request: dict[str, Any]) -> None:
    """Replace the document in the editor."""
    type_text(page, json.dumps(request))
    expect(page.locator("#fault")).to_have_text("")


def saved(page: Page, label: str) -> str:
    """What a button gives to take home, as text."""
    with page.expect_download() as caught:
        page.get_by_role("button", name=label, exact=True).click()
    return Path(caught.value.path()).read_text()


def document(page: Page) -> dict[str, Any]:
    """The document as it is now."""
    read: dict[str, Any] = json.loads(saved(page, "Save request"))
    return read


def plan(page: Page) -> None:
    """Plan, and wait for the certificate."""
    page.click("#plan")
    page.wait_for_selector("#result .certificate")
    expect(page.locator("#progress")).to_be_hidden()


def seek(page: Page, index: int) -> None:
    """Move the time to a sample."""
    page.locator("#time").evaluate(
        "(slider, i) => { slider.value = i; slider.dispatchEvent(new Event('input')); }", index
    )


def tool(page: Page) -> NDArray[np.float64]:
    """The tool's position as the page's scene has it, shape (3,) [m]."""
    cells = page.locator("#tool dd")
    return np.array(cells.evaluate_all("cells => cells.map(c => Number(c.dataset.value))"))


def settled(page: Page) -> None:
    """Wait until the arm is where it follows to."""
    page.wait_for_timeout(50)
    expect(page.locator("#stage")).to_have_attribute("data-following", "false")


def drag_handle(page: Page, right: float, down: float) -> None:
    """Drag the middle of the handles with the mouse [px]."""
    box = page.locator("#stage canvas").bounding_box()
    told = page.locator("#stage").get_attribute("data-handle")
    assert box is not None
    assert told is not None
    x, y = map(float, told.split(","))
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.wait_for_timeout(100)
    page.mouse.down()
    page.mouse.move(box["x"] + x + right / 2, box["y"] + y + down / 2)
    page.mouse.move(box["x"] + x + right, box["y"] + y + down)
    page.mouse.up()
