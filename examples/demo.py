"""Plan the helix of helix_iiwa14.json; write plan, table and figure to out/.

Run by ``make demo``; needs nothing but the installed package.
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

import ikplan
from ikplan.plans.summary import certificate_rows

HERE = Path(__file__).parent
OUT = Path.cwd() / "out"


def main() -> int:
    """Plan, save, draw, and print what the certificate says."""
    begin = time.perf_counter()
    request = json.loads((HERE / "helix_iiwa14.json").read_text())
    try:
        plan = ikplan.plan(request)
    except ikplan.IkplanError as error:
        print(f"demo: {error.slug}: {error.detail}", file=sys.stderr)
        return 2
    OUT.mkdir(exist_ok=True)
    for name in ("helix.json", "helix.csv"):
        plan.save(OUT / name)
    plan.plot(OUT / "helix.png")
    print(f"{plan.robot}: {len(plan.waypoints.q)} waypoints in {plan.duration:.3f} s, id {plan.id}")
    rows = certificate_rows(plan)
    width = max(len(label) for label, *_ in rows)
    for label, *values in rows:
        print(f"  {label:<{width}}  {'  '.join(str(v) for v in values)}")
    print("wrote out/helix.json, out/helix.csv, out/helix.png")
    print(f"took {time.perf_counter() - begin:.1f} s, loading included", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
