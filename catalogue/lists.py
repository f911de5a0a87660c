"""The lists that name the written robots: licences, notice and the table of the catalogue."""

from __future__ import annotations

import json
from collections import defaultdict
from pathlib import Path

from catalogue.bodies.sources import shape_source
from catalogue.facts import Facts

__all__ = ["listed"]

_NOTICE = "Figures from published descriptions, by licence and repository (`python -m catalogue`):"


def listed(facts: Facts, root: Path) -> dict[Path, str]:
    """What the lists hold, by their path in the checkout; the text around the lists stays.

    Args:
        facts: All facts.
        root: The checkout.
    """
    parts = {
        Path("licenses/robots.toml"): ("# Written by `python -m catalogue`:", _licences(facts)),
        Path("NOTICE"): (_NOTICE, _notice(facts)),
        Path("robots/README.md"): ("## Robots of published descriptions", _table(facts)),
    }
    return {
        path: (root / path).read_text(encoding="utf-8").partition(mark)[0] + f"{mark}\n\n{text}\n"
        for path, (mark, text) in parts.items()
    }


def _licences(facts: Facts) -> str:
    blocks = []
    for arm in facts.arms:
        source = facts.source_of(arm)
        name = source.repository.partition("/")[2]
        fields = {"name": name, "license": source.license}
        if source.where is not None:
            fields["where"] = source.where
        sources = [fields]
        if arm.acceleration_document is not None:
            sources.append(
                {
                    "name": "libfranka",
                    "license": "Apache-2.0",
                    "where": "include/franka/rate_limiting.h",
                }
            )
        for meshes in shape_source(arm.name):
            sources.append(
                {
                    "name": f"meshes of {meshes.package}",
                    "license": meshes.licence,
                    "where": meshes.where,
                }
            )
        rows = [
            "{" + ", ".join(f"{key} = {json.dumps(value)}" for key, value in row.items()) + "}"
            for row in sources
        ]
        blocks.append(f"[{arm.name}]\nsources = [{', '.join(rows)}]")
    return "\n\n".join(blocks)


def _notice(facts: Facts) -> str:
    names = defaultdict(list)
    for arm in facts.arms:
        source = facts.source_of(arm)
        names[f"{source.license}: {source.repository}"].append(arm.name)
    return "\n".join(f"- {what}: {', '.join(arms)}." for what, arms in names.items())


def _table(facts: Facts) -> str:
    rows = [
        "`python -m catalogue` writes these folders, this table, and their licences, from what the",
        "sources publish (`catalogue/facts.yaml`, with the commits). Official: the description is",
        "the maker's own; the others are written from data sheets by members of ROS-Industrial. A",
        "default acceleration is `velocity-limit-reached-in-0.6-s`. Homes are no source's: each is",
        "the best conditioned of 64 fixed postures in the middle 60 % of each range.",
        "",
        "| name | arm | joints | official | accelerations | source |",
        "|---|---|---|---|---|---|",
    ]
    for arm in sorted(facts.arms, key=lambda arm: arm.name):
        source = facts.source_of(arm)
        official = "yes" if source.official else "no"
        known = "published" if arm.joints[0].acceleration is not None else "default"
        rows.append(
            f"| `{arm.name}` | {arm.title} | {len(arm.joints)} | {official} | {known} "
            f"| {source.repository} {source.commit} |"
        )
    return "\n".join(rows)
