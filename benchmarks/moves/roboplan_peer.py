"""roboplan's RRT-Connect and shortcuts on the problems of MotionBenchMaker, by its own model.

It runs by itself, ``python benchmarks/moves/roboplan_peer.py panda``, with an interpreter that has
``pip install roboplan``: its libraries and those of ikplan's Pinocchio need not be the same.
"""

from __future__ import annotations

import argparse
import importlib
import json
import re
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np

_DESCRIPTIONS = {
    "panda": ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf"),
    "ur5": ("ur_description/urdf/ur5_robot.urdf", "ur_description/srdf/ur5.srdf"),
}
_NODES, _SECONDS, _SHORTCUTS = 20_000, 5.0, 100


def main() -> int:
    """Print times and lengths over the problems that are not left out."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("robot", choices=sorted(_DESCRIPTIONS))
    parser.add_argument("--robots-folder", type=Path, required=True, help="of example-robot-data")
    parser.add_argument("--without", nargs="*", default=[], help='problems left out, as "cage 1"')
    options = parser.parse_args()
    core: Any = importlib.import_module("roboplan.core")
    rrt: Any = importlib.import_module("roboplan.rrt")
    file = Path(__file__).parent / "scenes" / f"{options.robot}.json"
    problems = json.loads(file.read_text())["problems"]
    search, shortened, found, length, solved = [], [], [], [], []
    for problem in problems:
        if f"{problem['set']} {problem['index']}" in options.without:
            continue
        scene, names = _scene(core, options.robot, options.robots_folder, problem)
        start, goal = (
            core.JointConfiguration(names, np.array(problem[end])) for end in ("start", "goal")
        )
        planner = rrt.RRT(
            scene,
            rrt.RRTOptions(
                group_name="moved", max_nodes=_NODES, max_planning_time=_SECONDS, rrt_connect=True
            ),
        )
        planner.setRngSeed(1)
        cutter = core.PathShortcutter(
            scene, core.PathShortcuttingOptions(group_name="moved", max_iters=_SHORTCUTS)
        )
        begin = time.process_time()
        try:
            path = planner.plan(start, goal)
        except RuntimeError:
            solved.append(False)
            search.append(1e3 * (time.process_time() - begin))
            continue
        search.append(1e3 * (time.process_time() - begin))
        solved.append(True)
        shorter = cutter.shortcut(path)
        shortened.append(1e3 * (time.process_time() - begin))
        found.append(_length(path))
        length.append(_length(shorter))
    search_row, short_row = (np.percentile(v, [50, 95]).round(1) for v in (search, shortened))
    print(
        f"roboplan {options.robot}: {100.0 * np.mean(solved):.1f} % of {len(solved)} solved; "
        f"search {search_row[0]} / {search_row[1]} ms; with shortening {short_row[0]} / "
        f"{short_row[1]} ms; length {np.median(found):.2f} -> {np.median(length):.2f} "
        f"(mean {np.mean(length):.2f})"
    )
    return 0


def _length(path: Any) -> float:
    steps = np.diff(np.array(path.positions), axis=0)
    return float(np.linalg.norm(steps, axis=1).sum())


def _scene(core: Any, robot: str, folder: Path, problem: dict[str, Any]) -> tuple[Any, list[str]]:
    urdf, srdf = (folder / path for path in _DESCRIPTIONS[robot])
    text = urdf.read_text()
    for finger, open_by in (("1", 0.04), ("2", -0.04)):  # open and fixed, as in the problems
        text = re.sub(
            rf'(<joint name="panda_finger_joint{finger}" type=")prismatic(".*?<origin[^>]*xyz=")'
            r"0 0 ([^\"]*)",
            rf"\g<1>fixed\g<2>0 {open_by} \g<3>",
            text,
            flags=re.DOTALL,
        )
    description = core.loadUrdfSceneDescriptionFromXml(text, [folder, folder.parent.parent])
    scene = core.Scene(robot, description)
    names = [name for name in scene.getJointNames() if "finger" not in name]
    scene.addGroup("moved", names)
    disabled = re.findall(r'<disable_collisions link1="([^"]+)" link2="([^"]+)"', srdf.read_text())
    scene.setCollisions(disabled, False)
    obstacles = []
    for k, part in enumerate(problem["obstacles"]):
        T = np.eye(4, order="F")
        T[:3, :3] = np.array(part["rotation"]).reshape(3, 3)
        T[:3, 3] = part["position"]
        name, colour = f"obstacle {k}", np.ones(4)
        if part["type"] == "box":
            scene.addBoxGeometry(name, "universe", core.Box(*part["size"]), T, colour)
        else:
            shape = core.Cylinder(part["radius"], part["length"])
            scene.addCylinderGeometry(name, "universe", shape, T, colour)
        obstacles.append(name)
    scene.setCollisions([(a, b) for a in obstacles for b in obstacles if a < b], False)
    return scene, names


if __name__ == "__main__":
    sys.exit(main())
