"""The manual in a browser: it asks the service itself, with a key where one is needed."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, Response, expect

from ikplan.client.api_keys import key_hash, new_key
from ikplan_api.settings import Settings

from .browser import NoPlanner, Visit, served

KEY = new_key()


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    with served(Settings(api_keys=f"cell:{key_hash(KEY)}"), NoPlanner()) as running:
        yield running


@pytest.fixture
def visit(address: str, browser: Browser) -> Iterator[Visit]:
    made = Visit(browser, address, width=1100, height=900, dark=False)
    made.page.goto(f"{address}/docs")
    made.page.wait_for_selector(".opblock")
    yield made
    made.close()


def execute(page: Page, operation: str, path: str) -> Response:
    """The answer to a click on "Execute" of an operation."""
    block = page.locator(f".opblock[id$={operation}]")
    if block.locator("button.execute").count() == 0:
        block.locator(".opblock-summary-control").click()
    with page.expect_response(lambda answer: answer.url.endswith(path)) as answer:
        block.locator("button.execute").click()
    expect(block.locator(".live-responses-table tbody .response-col_status").first).to_contain_text(
        str(answer.value.status)
    )
    return answer.value


def test_operations_are_tried_on_the_service_itself(visit: Visit) -> None:
    page = visit.page
    assert execute(page, "list_solvers", "/v1/solvers").status == 401
    page.locator(".scheme-container button.authorize").click()
    page.locator(".auth-container input").fill(KEY)
    page.locator(".auth-container button[type=submit]").click()
    page.locator(".auth-container button.btn-done").click()
    assert execute(page, "list_solvers", "/v1/solvers").status == 200
    # The example in the document is the body, unchanged.
    answer = execute(page, "upload_scene", "/v1/scenes")
    assert answer.status == 201
    assert answer.request.header_value("content-type") == "application/json"
    assert visit.foreign == []
    assert visit.faults == []


def test_the_pages_of_problems_keep_their_policy(visit: Visit, address: str) -> None:
    page = visit.page
    page.locator("nav.top a[href=problems]").click()
    page.locator("main a", has_text="In collision").click()
    expect(page.locator("h1")).to_have_text("In collision")
    assert page.url == f"{address}/problems/in-collision"
    page.locator("nav.top a", has_text="Manual").click()
    page.wait_for_selector(".opblock")
    assert page.url == f"{address}/docs"
    assert visit.faults == []
    assert visit.foreign == []
