"""A plan in the scene of the service's page, as one HTML document: for notebooks and for files.

The document holds all that it shows, the robot's meshes included, and asks for nothing.
"""

from __future__ import annotations

import base64
import html
import json
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ikplan.documents import parse
from ikplan.documents.scene import Scene, ToolFrame
from ikplan.errors import InvalidRequest

if TYPE_CHECKING:
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.robots import Robot

__all__ = ["Viewer", "view_plan"]

_PLACE = "%DOCUMENT%"


@dataclass(frozen=True, repr=False)
class Viewer:
    """A plan to be looked at: a notebook shows it, a browser opens its file.

    Attributes:
        document: The HTML document.
        height: Height in a notebook [pixels].
    """

    document: str
    height: int = 420

    def save(self, path: str | Path) -> None:
        """Write the document to a file.

        Raises:
            OSError: The file cannot be written.
        """
        Path(path).write_text(self.document, encoding="utf-8")

    def __repr__(self) -> str:
        """Return its size: the document is long."""
        return f"Viewer({len(self.document)} characters)"

    def _repr_html_(self) -> str:
        """Return a frame that holds the document, and lets it reach nothing of the notebook."""
        return (
            f'<iframe title="A plan" sandbox="allow-scripts" width="100%" height="{self.height}" '
            f'style="border:0" srcdoc="{html.escape(self.document)}"></iframe>'
        )


def view_plan(
    plan: PlanDocument,
    scene: Mapping[str, Any] | Scene | None = None,
    tool: Mapping[str, Any] | ToolFrame | None = None,
    robot: Robot | None = None,
    *,
    meshes: bool = True,
    height: int = 420,
) -> Viewer:
    """Return the viewer of a plan; see :meth:`ikplan.Plan.show`."""
    shell = _shell()
    known, urdf = _robot_of(plan, robot)
    from ikplan.robots import robot_visual

    visual = robot_visual(known, urdf if meshes else b"", str)
    request: dict[str, Any] = {"robot": plan.robot}
    if scene is not None:
        request["scene"] = _written(parse(Scene, scene))
    if tool is not None:
        request["tool"] = _written(parse(ToolFrame, tool))
    motion = plan.trajectory
    document = {
        "robot": known.info().model_dump(mode="json"),
        "visual": visual.urdf,
        "meshes": {path: _letters(file) for path, file in sorted(visual.meshes.items())},
        "trajectory": {
            "time": motion.time.tolist(),
            "q": motion.q.tolist(),
            "dq": motion.dq.tolist(),
            "ddq": motion.ddq.tolist(),
        },
        "waypoints": plan.waypoints.q.tolist(),
        "clearance": plan.certificate.model_dump(mode="json")["clearance"],
        "request": request,
    }
    # "</" would end the element that holds the text.
    text = json.dumps(document, allow_nan=False, separators=(",", ":")).replace("</", "<\\/")
    return Viewer(shell.replace(_PLACE, text), height)


def _written(document: Any) -> dict[str, Any]:
    written: dict[str, Any] = document.model_dump(mode="json", exclude_unset=True)
    return written


def _letters(file: Path) -> str:
    return base64.b64encode(file.read_bytes()).decode("ascii")


def _robot_of(plan: PlanDocument, robot: Robot | None) -> tuple[Robot, bytes]:
    from ikplan.robots import catalogue_robot
    from ikplan.robots.load import catalogue_documents

    if robot is None:
        return catalogue_robot(plan.robot), catalogue_documents(plan.robot)[1]
    if robot.name != plan.robot or list(robot.joint_names) != list(plan.joint_names):
        raise InvalidRequest(
            f"the plan is for {plan.robot!r}, and the robot given is {robot.name!r}",
            field="robot",
            allowed=plan.robot,
        )
    return robot, robot.description.shapes.urdf


def _shell() -> str:
    """The page that shows a plan, without one: of the installed package, else of the checkout.

    Raises:
        InvalidRequest: It has not been made.
    """
    service = find_spec("ikplan_api")
    folders = (
        [Path(p) / "page" for p in service.submodule_search_locations or ()] if service else []
    )
    folders.append(Path(__file__).resolve().parents[2] / "web" / "dist")
    for folder in folders:
        file = folder / "embed.html"
        if file.is_file():
            return file.read_text(encoding="utf-8")
    raise InvalidRequest(
        "show needs the page of the service, which this checkout has not built: make page",
        field="show",
    )
