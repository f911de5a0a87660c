"""The pages of the repository: what they link to and name exists, in the version that there is."""

from __future__ import annotations

import ast
import re
import tomllib
from pathlib import Path

import pytest
import yaml

import ikplan
from ikplan import PlanRequest, TimingRequest, errors

ROOT = Path(__file__).parents[2]
PATTERNS = ("*.md", "docs/*.md", "robots/*.md", "docker/*.md", "web/*.md", "benchmarks/**/*.md")
PAGES = sorted(page for pattern in PATTERNS for page in ROOT.glob(pattern))
ARCHITECTURE = (ROOT / "docs" / "architecture.md").read_text()
CITATION = yaml.safe_load((ROOT / "CITATION.cff").read_text())
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]


def prose(page: Path) -> str:
    """A page without its code blocks."""
    return re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)


def anchors(page: Path) -> set[str]:
    titles = re.findall(r"^#+ (.+)$", prose(page), re.MULTILINE)
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for link in re.findall(r"\]\((?!https?:)([^)\s]+)\)", prose(page)):
        path, _, anchor = link.partition("#")
        target = (page.parent / path).resolve() if path else page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), link


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "SECURITY.md", "docs/architecture.md"])
def test_files_and_folders_named_exist(name: str) -> None:
    named = re.findall(r"`((?:[\w.]+/)+[\w.*-]*|[\w-]+\.(?:md|toml|txt|py))`", prose(ROOT / name))
    assert named
    for path in named:
        beside = [ROOT, ROOT / "ikplan/certificate/requested"]
        assert any((folder / path).exists() for folder in beside), path


@pytest.mark.parametrize("name", ["CONTRIBUTING.md", "benchmarks/mutants/README.md"])
def test_make_targets_named_exist(name: str) -> None:
    makefile = (ROOT / "Makefile").read_text()
    named = set(re.findall(r"(?:^|`)make ([a-z]+)", (ROOT / name).read_text(), re.MULTILINE))
    assert named
    assert named <= set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))


def test_every_target_is_in_the_help() -> None:
    makefile = (ROOT / "Makefile").read_text()
    phony = re.search(r"^\.PHONY: (.+)$", makefile, re.MULTILINE)
    assert phony
    shown = re.findall(r"^([a-z]+):.*  ?## ?", makefile, re.MULTILINE)
    assert sorted(shown) == sorted(phony[1].split())


def test_modules_to_run_exist() -> None:
    for module in re.findall(
        r"python -m (benchmarks\.\w+)", (ROOT / "CONTRIBUTING.md").read_text()
    ):
        assert (ROOT / module.replace(".", "/") / "__main__.py").exists()


def test_every_error_in_the_picture_exists() -> None:
    named = re.findall(r"\b[A-Z]\w+(?:Failed|Found|Exceeded|Violated)\b", ARCHITECTURE)
    assert named
    for name in named:
        assert issubclass(getattr(ikplan, name), ikplan.IkplanError)


def test_the_names_in_the_table_are_those_of_the_documents_and_the_code() -> None:
    table = (ROOT / "CONTRIBUTING.md").read_text().partition("## Names")[2]
    rows = [line.split("|")[1:4] for line in table.splitlines() if line.startswith("| ")][1:]
    schemas = [m.model_json_schema() for m in (PlanRequest, TimingRequest, ikplan.Plan)]
    problems = {name for e in vars(errors).values() for name in getattr(e, "fields", ())}
    fields = problems | {
        name
        for schema in schemas
        for part in (schema, *schema["$defs"].values())
        for name in part.get("properties", {})
    }
    defined = {
        node.name
        for file in (ROOT / "ikplan").rglob("*.py")
        for node in ast.walk(ast.parse(file.read_text()))
        if isinstance(node, ast.ClassDef | ast.FunctionDef)
    }
    assert len(rows) > 10
    for concept, document, code in rows:
        assert set(re.findall(r"`(\w+)`", document)) <= fields, concept
        (name,) = re.findall(r"`(\w+)`", code)  # one concept, one name
        assert code.strip() == f"`{name}`", concept
        assert name in defined, concept
    assert len({code for _, _, code in rows}) == len(rows)


def test_terms_are_in_order_and_explained_once() -> None:
    text = (ROOT / "docs" / "glossary.md").read_text()
    terms = [t.casefold() for t in re.findall(r"^\*\*([^*]+)\*\*: ", text, re.MULTILINE)]
    assert terms == sorted(set(terms))
    assert len(terms) == len(re.findall(r"^\*\*", text, re.MULTILINE))


def test_the_version_is_the_same_everywhere() -> None:
    label = re.search(r'image\.version="([^"]+)"', (ROOT / "docker" / "Dockerfile").read_text())
    assert label
    assert {PROJECT["version"], CITATION["version"], label[1]} == {ikplan.__version__}


def test_the_citation_names_the_papers_of_the_solvers() -> None:
    from ikplan.ik.catalogue.sources import KANAGARAJ, LI, SLIM
    from ikplan.ik.registry import solvers

    assert CITATION["license"] == PROJECT["license"]
    assert len(CITATION["references"]) == 3
    for reference, source in zip(CITATION["references"], (SLIM, KANAGARAJ, LI), strict=True):
        names = ", ".join(author["family-names"] for author in reference["authors"])
        assert source.startswith(f"{names}, {reference['title']}, {reference['journal']} ")
        for figure in (reference["year"], reference["volume"], reference["start"]):
            assert str(figure) in source
        named = reference["notes"].removeprefix("Solvers: ").split(", ")
        assert set(named) == {s.name for s in solvers() if s.source.startswith(source)}
