"""Writes the bill of materials of the container: ``python docker/sbom.py FILE`` (``make sbom``).

CycloneDX 1.6 in JSON: what ``docker/requirements.txt`` installs, with hashes, and the licences that
``licenses/dependencies.toml`` has on record. The same files give the same bytes.
"""

from __future__ import annotations

import json
import re
import sys
import tomllib
import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
_ENTRY = re.compile(r"^([A-Za-z0-9._-]+)==(\S+)((?: \\\n    --hash=sha256:[0-9a-f]{64})+)", re.M)


def locked(path: Path) -> Iterator[tuple[str, str, list[str]]]:
    """Yield name, version and SHA-256 hashes of the entries of a requirements file."""
    for name, version, hashes in _ENTRY.findall(path.read_text()):
        yield name, version, re.findall("[0-9a-f]{64}", hashes)


def document() -> dict[str, Any]:
    """Return the bill of materials."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    licences = tomllib.loads((ROOT / "licenses" / "dependencies.toml").read_text())
    components = [
        _component(name, version, hashes, licences)
        for name, version, hashes in locked(ROOT / "docker" / "requirements.txt")
    ]
    root = f"pkg:pypi/{project['name']}@{project['version']}"
    content = json.dumps(components, sort_keys=True)
    return {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid.uuid5(uuid.NAMESPACE_URL, root + content)}",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": root,
                "name": project["name"],
                "version": project["version"],
                "purl": root,
                "licenses": [{"license": {"id": project["license"]}}],
            }
        },
        "components": components,
        "dependencies": [{"ref": root, "dependsOn": [c["bom-ref"] for c in components]}],
    }


def _component(
    name: str, version: str, hashes: list[str], licences: dict[str, Any]
) -> dict[str, Any]:
    canonical = re.sub(r"[-_.]+", "-", name).lower()
    purl = f"pkg:pypi/{canonical}@{version}"
    component: dict[str, Any] = {
        "type": "library",
        "bom-ref": purl,
        "name": canonical,
        "version": version,
        "purl": purl,
        # One file for each processor family.
        "externalReferences": [
            {
                "type": "distribution",
                "url": purl,
                "hashes": [{"alg": "SHA-256", "content": digest}],
            }
            for digest in hashes
        ],
    }
    if canonical in licences:
        component["licenses"] = [{"expression": licences[canonical]["license"]}]
    return component


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(json.dumps(document(), indent=1) + "\n")
