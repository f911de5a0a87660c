"""Looks for known faults of what the container installs: ``python docker/audit.py``.

pip-audit does it, installed into a temporary environment. Where its data cannot be reached, that is
said, and it is no failure.
"""

from __future__ import annotations

import subprocess
import sys
import tempfile
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
_UNREACHABLE = ("ConnectionError", "ServiceError", "Max retries", "ProxyError", "timed out")


def main() -> int:
    """Run pip-audit; return 1 if it finds a fault."""
    with tempfile.TemporaryDirectory() as folder:
        venv.create(folder, with_pip=True)
        python = str(Path(folder) / "bin" / "python")
        installed = subprocess.run([python, "-m", "pip", "install", "--quiet", "pip-audit"])
        if installed.returncode:
            print("not audited: pip-audit cannot be installed here")
            return 0
        lock = ROOT / "docker" / "requirements.txt"
        audit = subprocess.run(
            [python, "-m", "pip_audit", "--disable-pip", "--no-deps", "--requirement", str(lock)],
            capture_output=True,
            text=True,
        )
    told = audit.stdout + audit.stderr
    if audit.returncode and any(word in told for word in _UNREACHABLE):
        print("not audited: the data of known faults cannot be reached from here")
        return 0
    print(told.strip())
    return int(audit.returncode != 0)


if __name__ == "__main__":
    sys.exit(main())
