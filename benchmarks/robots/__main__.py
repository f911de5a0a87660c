"""Print how descriptions load: ``python -m benchmarks.robots [--packages FOLDER] [--lines]``."""

from __future__ import annotations

import os

for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(_name, "1")

import argparse  # noqa: E402 - the threads are counted when NumPy is imported
import time  # noqa: E402
from pathlib import Path  # noqa: E402

import numpy as np  # noqa: E402
import pinocchio as pin  # noqa: E402

import ikplan  # noqa: E402
from benchmarks.robots.corpus import (  # noqa: E402
    PACKAGES,
    is_single_arm,
    urdf_files,
    xacro_files,
)
from ikplan.errors import IkplanError  # noqa: E402
from ikplan.robots import Robot, load_robot, robot_from_urdf  # noqa: E402
from ikplan.robots.loading.checking import check_against_whole  # noqa: E402
from ikplan.robots.loading.home import conditioning  # noqa: E402
from ikplan.robots.loading.sources import read_source  # noqa: E402
from ikplan.robots.loading.xacro_files import expand_xacro  # noqa: E402

LENGTH = 0.1
DIRECTIONS = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0))
BUDGET_S = 20.0
RANK = 1e-3
"""An arm whose best posture of all is conditioned worse has no posture with six ranks."""


def load(files: list[Path]) -> list[Robot]:
    """Load every single arm with no argument; tell how many, and why not the others."""
    robots, failed, asked = [], [], 0
    for file in files:
        single = is_single_arm(file)
        try:
            robot = load_robot(file)
            if single:
                robots.append(robot)
        except IkplanError as error:
            if single:
                failed.append(str(error)[:200])
            asked += not single
    count = len(robots) + len(failed)
    print(
        f"{len(files)} URDFs; {count} of single arms: {len(robots)} load with no argument", end=""
    )
    print(f" ({len(robots) / count:.1%}); {asked} of the others are refused with a message")
    for message in failed:
        print(f"  {message}")
    return robots


def check(files: list[Path]) -> None:
    """Hold forward kinematics to Pinocchio's on the whole file."""
    equal, not_read = 0, 0
    for file in files:
        try:
            source = read_source(file)
            found = check_against_whole(load_robot(file), source.urdf)
        except IkplanError:
            continue
        equal += found.startswith("forward")
        not_read += not found.startswith("forward")
    print(f"forward kinematics equal Pinocchio's on {equal} whole files; {not_read} it refuses")


def expand(files: list[Path]) -> None:
    """Expand every xacro file; the robot must be that of the expanded file."""
    expanded, same, loaded, reasons = 0, 0, 0, []
    started = time.process_time()
    for file in files:
        try:
            urdf = expand_xacro(file, {})
        except IkplanError as error:
            reasons.append(f"{file.name}: {str(error).split('xacro: ')[-1][:150]}")
            continue
        expanded += 1
        try:
            robot = load_robot(file)
        except IkplanError:  # a part of others, or several arms
            continue
        loaded += 1
        other = robot_from_urdf(urdf)
        q = robot.random_configuration(np.random.default_rng(1))
        same += np.array_equal(robot.fk(q).homogeneous, other.fk(q).homogeneous)
    spent = time.process_time() - started
    print(f"{len(files)} xacro files: {expanded} expand; of {loaded} that are one robot {same} are")
    print(f"  that of the expanded file; {spent:.1f} s of processor time")
    for reason in reasons:
        print(f"  {reason}")


def draw_lines(robots: list[Robot]) -> None:
    """Plan lines of 100 mm in four directions from home, the orientation kept."""
    arms = list({r.fingerprint: r for r in robots if r.dof in (6, 7)}.values())
    flat = [r.name for r in arms if conditioning(r, r.home[None])[0] < RANK]
    print(f"{len(flat)} arms of 6 or 7 joints cannot turn and shift their tool in every way, such")
    print(f"  as planar ones, and are left out below: {', '.join(flat)}")
    arms = [r for r in arms if r.name not in flat]
    planned, every, reasons = 0, 0, []
    for robot in arms:
        pose = robot.fk(robot.home)
        quaternion = pin.Quaternion(pose.rotation).coeffs().tolist()
        good = 0
        for direction in DIRECTIONS:
            goal = (pose.translation + LENGTH * np.array(direction)).tolist()
            waypoint = {"position": goal, "quaternion_xyzw": quaternion}
            path = {"waypoints": [waypoint], "interpolation": "line"}
            request = {"robot": robot.name, "path": path, "budget_s": BUDGET_S}
            try:
                ikplan.plan(request, robot=robot)
                good += 1
            except IkplanError as error:
                reasons.append(f"{robot.name} {direction}: {str(error)[:160]}")
        planned += good
        every += good == len(DIRECTIONS)
    count = len(arms) * len(DIRECTIONS)
    print(
        f"{len(arms)} arms of 6 or 7 joints, lines of 100 mm from home: {planned} of {count} ",
        end="",
    )
    print(f"planned ({planned / count:.1%}); all four on {every} arms")
    for reason in reasons:
        print(f"  {reason}")


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--packages", type=Path, help=f"a folder that pip installed into: {', '.join(PACKAGES)}"
    )
    parser.add_argument("--lines", action="store_true", help="plan lines too (minutes)")
    options = parser.parse_args()
    files = urdf_files(options.packages)
    robots = load(files)
    check(files)
    expand(xacro_files(options.packages))
    if options.lines:
        draw_lines(robots)


if __name__ == "__main__":
    main()
