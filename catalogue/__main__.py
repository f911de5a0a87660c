"""``python -m catalogue``: write the robots of ``facts.yaml`` and the lists that name them."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from catalogue.documents import robot_document
from catalogue.facts import read_facts
from catalogue.lists import listed

ROOT = Path(__file__).parents[1]


def written() -> dict[Path, str]:
    """What each written file holds, by its path in the checkout."""
    facts = read_facts()
    files = {
        Path("robots", arm.name, "robot.yaml"): robot_document(facts, arm) for arm in facts.arms
    }
    return files | listed(facts, ROOT)


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the files, or tell which are not as they would be written."""
    parser = argparse.ArgumentParser(prog="python -m catalogue", description=__doc__)
    parser.add_argument("--check", action="store_true", help="write nothing; exit 1 if one differs")
    options = parser.parse_args(arguments)
    differing = []
    for path, text in written().items():
        file = ROOT / path
        if not file.is_file() or file.read_text(encoding="utf-8") != text:
            differing.append(path)
            if not options.check:
                file.parent.mkdir(exist_ok=True)
                file.write_text(text, encoding="utf-8")
    print(*differing, sep="\n")
    return 1 if options.check and differing else 0


if __name__ == "__main__":
    sys.exit(main())
