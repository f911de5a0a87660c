"""The manual at /docs: Swagger UI of this service alone, and the pages of the problem types."""

from __future__ import annotations

import re
from collections.abc import Iterator
from urllib.parse import urljoin

import httpx
import pytest
from anyio.from_thread import start_blocking_portal

from ikplan import errors
from ikplan_api.app import create_app
from ikplan_api.documentation.problem_pages import PAGES
from ikplan_api.documentation.problem_words import WORDS
from ikplan_api.http.schemas import PROBLEMS
from ikplan_api.settings import Settings

from .conftest import ADDRESS, PortalTransport
from .stand_in import StandIn

HTML = "text/html; charset=utf-8"


@pytest.fixture(scope="module")
def http() -> Iterator[httpx.Client]:
    """The service without its lifespan: what is asked for here needs no planner."""
    with start_blocking_portal() as portal:
        transport = PortalTransport(create_app(Settings(), planner=StandIn()), portal)
        with httpx.Client(base_url=ADDRESS, transport=transport) as client:
            yield client


def descendants(cls: type[errors.IkplanError]) -> set[type[errors.IkplanError]]:
    return {cls}.union(*(descendants(sub) for sub in cls.__subclasses__()))


ERRORS = sorted(
    (cls for cls in descendants(errors.IkplanError) if "slug" in cls.__dict__),
    key=lambda cls: cls.__name__,
)
RAISED = [cls for cls in ERRORS if cls is not errors.IkplanError]


def addresses(page: httpx.Response) -> list[str]:
    """What a page names in its tags, as a browser would ask for it."""
    found = re.findall(r"""(?:src|href|action)=["']?([^"'\s>]+)""", page.text)
    return [urljoin(str(page.url), a) for a in found if not a.startswith("data:")]


def test_the_manual_asks_this_service_alone_and_runs_nothing_inline(http: httpx.Client) -> None:
    page = http.get("/docs")
    assert page.headers["content-type"] == HTML
    directives = page.headers["content-security-policy"].split(";")
    policy = dict(d.strip().split(" ", 1) for d in directives)
    assert policy["default-src"] == "'none'"
    assert policy["script-src"] == policy["connect-src"] == policy["style-src"] == "'self'"
    assert not re.search(r"unsafe|https?:|\*", " ".join(policy.values()))
    assert not re.search(r"<script(?![^>]* src=)|<style|style=|\son\w+=", page.text)
    named = addresses(page)
    assert len(named) >= 6
    for address in named:
        assert address.startswith(str(http.base_url))
        assert http.get(address).status_code == 200


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("swagger-ui-bundle.js", "text/javascript"),
        ("start.js", "text/javascript"),
        ("swagger-ui.css", "text/css"),
        ("style.css", "text/css"),
    ],
)
def test_a_part_of_the_manual_is_sent_once(http: httpx.Client, name: str, kind: str) -> None:
    first = http.get(f"/docs/{name}")
    assert first.headers["content-type"].startswith(kind)
    assert len(first.content) > 100
    assert "sourceMappingURL=http" not in first.text
    again = http.get(f"/docs/{name}", headers={"if-none-match": first.headers["etag"]})
    assert again.status_code == 304


@pytest.mark.parametrize(
    "name",
    ["swagger_ui.py", "__init__.py", "none", "../app.py", "..%2fapp.py", "favicon-32x32.png"],
)
def test_nothing_else_is_a_part_of_the_manual(http: httpx.Client, name: str) -> None:
    assert http.get(f"/docs/{name}").status_code == 404


def test_every_error_class_has_a_page_of_its_own() -> None:
    assert set(RAISED) == WORDS.keys() == PROBLEMS.keys()
    assert {cls.slug for cls in RAISED} == PAGES.keys()


@pytest.mark.parametrize("cls", RAISED, ids=lambda cls: cls.slug)
def test_a_page_says_what_the_problem_means_and_what_to_do(
    http: httpx.Client, cls: type[errors.IkplanError]
) -> None:
    page = http.get(f"/problems/{cls.slug}")
    assert page.headers["content-type"] == HTML
    assert "script-src" not in page.headers["content-security-policy"]
    assert not re.search(r"<script|<style|style=", page.text)
    plain = http.get(f"/problems/{cls.slug}", headers={"accept": "text/markdown"})
    assert plain.headers["content-type"] == "text/markdown; charset=utf-8"
    assert plain.headers["vary"].lower().startswith("accept")
    meaning = (cls.__doc__ or "").partition("\n")[0]
    for text in (page.text, plain.text):
        assert cls.problem_type() in text
        assert cls.__name__ in text
        assert cls.title in text
        assert meaning.rstrip(".") in text
        assert "What to do" in text
        assert not re.search(r"``|\bNone\b", text)
    listed = re.findall(r"^- `(\w+)`: (.+)", plain.text, re.MULTILINE)
    assert tuple(name for name, _ in listed) == cls.fields
    assert all(len(words) > 5 for _, words in listed)
    for address in addresses(page):
        assert http.get(address).status_code == 200


def test_a_page_names_every_status_of_the_document(http: httpx.Client) -> None:
    seen = set()
    document = http.get("/openapi.json").json()
    by_model = {model.__name__: cls for cls, model in PROBLEMS.items()}
    for methods in document["paths"].values():
        for operation in methods.values():
            for status, answer in operation["responses"].items():
                for model in re.findall(r"schemas/(\w+Problem)'", str(answer)):
                    cls = by_model[model]
                    assert int(status) in dict(PAGES[cls.slug].statuses), (cls, status)
                    seen.add(cls)
    assert len(seen) > 10
    schemas = document["components"]["schemas"]
    for name, cls in by_model.items():
        linked = urljoin("/openapi.json", schemas[name]["externalDocs"]["url"])
        assert linked == f"/problems/{cls.slug}"


@pytest.mark.parametrize(
    ("accept", "kind"),
    [
        (None, "text/html"),
        ("*/*", "text/html"),
        ("text/html,application/xhtml+xml,*/*;q=0.8", "text/html"),
        ("text/plain", "text/plain"),
        ("text/markdown;q=0.9, text/html;q=0.1", "text/markdown"),
        ("application/json", "text/html"),
    ],
)
@pytest.mark.parametrize("path", ["/problems", "/problems/unreachable"])
def test_words_come_as_the_reader_wants_them(
    http: httpx.Client, path: str, accept: str | None, kind: str
) -> None:
    page = http.get(path, headers={"accept": accept} if accept else {})
    assert page.headers["content-type"] == f"{kind}; charset=utf-8"
    assert page.text.startswith("<!doctype html>" if kind == "text/html" else "# ")


def test_the_list_leads_to_every_page(http: httpx.Client) -> None:
    named = addresses(http.get("/problems"))
    assert {urljoin(str(http.base_url), f"/problems/{slug}") for slug in PAGES} <= set(named)
    plain = http.get("/problems", headers={"accept": "text/markdown"}).text
    assert re.findall(r"\]\(problems/([\w-]+)\)", plain) == list(PAGES)


def test_a_type_that_does_not_exist_has_no_page(http: httpx.Client) -> None:
    for slug in ("none", "error", "unreachable.md", "Unreachable"):
        assert http.get(f"/problems/{slug}").status_code == 404


def test_a_problem_leads_to_its_page(http: httpx.Client) -> None:
    answer = http.post("/v1/fk", content=b"{}", headers={"content-type": "text/x-none"})
    assert (answer.status_code, answer.json()["type"]) == (415, "urn:ikplan:invalid-request")
    link = answer.links["help"]["url"]
    assert link == "/problems/invalid-request"
    assert "Invalid request" in http.get(link).text
    assert "link" not in http.get("/nowhere").headers
