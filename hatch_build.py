"""Puts the page into the wheel, where it has been made (``make page``)."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PageHook(BuildHookInterface):  # type: ignore[misc]
    """Adds ``web/dist`` as ``ikplan_api/page``; without it, the service says how to make it."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Name the files to be included."""
        bundle = Path(self.root) / "web" / "dist"
        if version == "standard" and (bundle / "index.html").is_file():
            build_data["force_include"][str(bundle)] = "ikplan_api/page"
