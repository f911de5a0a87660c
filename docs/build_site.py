"""Build the site of the documentation, and see that it loads nothing from elsewhere.

``python docs/build_site.py out/site``: warnings are errors.
"""

from __future__ import annotations

import argparse
import html.parser
import re
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
LOADS = {"src", "srcset", "data", "poster", "background", "action"}
"""Attributes whose address a browser loads; those of links are loaded for styles and the like."""
REMOTE = re.compile(r"^\s*(?:[a-z][a-z0-9+.-]*:)?//", re.IGNORECASE)
IN_STYLE = re.compile(r"""(?:url\(|@import)\s*["']?\s*((?:https?:)?//[^"')\s;]+)""", re.IGNORECASE)


class Loads(html.parser.HTMLParser):
    """Collects the addresses of other hosts that a page makes a browser load."""

    def __init__(self) -> None:
        super().__init__()
        self.remote: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Look at the attributes of an element."""
        for name, value in attrs:
            loads = name in LOADS or (name == "href" and tag != "a") or name == "style"
            if loads and value:
                found = IN_STYLE.findall(value) if name == "style" else [value]
                self.remote += [address for address in found if REMOTE.match(address)]

    def handle_data(self, data: str) -> None:
        """Look at styles within the page."""
        if self.cdata_elem == "style":
            self.remote += IN_STYLE.findall(data)


def remote_assets(site: Path) -> list[str]:
    """Return what the pages and styles of a site load from other hosts, as "file: address"."""
    found = []
    for file in sorted(site.rglob("*")):
        addresses: list[str] = []
        if file.suffix == ".html":
            page = Loads()
            page.feed(file.read_text())
            addresses = page.remote
        elif file.suffix == ".css":
            addresses = IN_STYLE.findall(file.read_text())
        found += [f"{file.relative_to(site)}: {address}" for address in addresses]
    return found


def main() -> int:
    """Build into the folder named; the exit code is 1 if there is a warning or a remote asset."""
    from sphinx.cmd.build import build_main

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("site", type=Path, help="folder of the site")
    site: Path = parser.parse_args().site
    doctrees = site.with_name(f"{site.name}-doctrees")
    strict = ["--quiet", "--fail-on-warning", "--keep-going", "--doctree-dir", str(doctrees)]
    failed = build_main([*strict, "--conf-dir", str(ROOT / "docs"), str(ROOT), str(site)])
    remote = remote_assets(site)
    for line in remote:
        sys.stderr.write(f"loaded from another host: {line}\n")
    return 1 if failed or remote else 0


if __name__ == "__main__":
    sys.exit(main())
