"""Names the wheel after what its kernels are compiled for."""

from __future__ import annotations

import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class KernelsHook(BuildHookInterface):  # type: ignore[misc]
    """Refuses to make a wheel without kernels; no other Python or platform can use it."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:  # noqa: ARG002
        """Set the wheel's tag."""
        if not (Path(self.root) / "ikplan_kernels" / "kernels.pack").is_file():
            raise FileNotFoundError("no kernels.pack: `make kernels` makes it")
        python = f"cp{sys.version_info.major}{sys.version_info.minor}"
        platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
        build_data["pure_python"] = False
        build_data["tag"] = f"{python}-{python}-{platform}"
