"""A plan: its document, and what is made of it."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from numpy.typing import ArrayLike

from ikplan.documents.plan_document import PlanDocument

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.figure import Figure
    from pandas import DataFrame

    from ikplan.documents.limits import LimitOptions
    from ikplan.documents.scene import Scene, ToolFrame
    from ikplan.plans.playback import JointState
    from ikplan.plans.viewer import Viewer
    from ikplan.robots import Robot

__all__ = ["Plan"]


class Plan(PlanDocument):
    """A certified joint trajectory."""

    def at(self, t: ArrayLike) -> JointState:
        """Evaluate the motion at any times.

        Exact where the plan has its motion as polynomials (``sampling.form`` "polynomial"),
        otherwise exact at the samples and between them by the cubics that have their positions
        and velocities, with accelerations linear between those of the samples.

        Args:
            t: A time, or times of shape (m,) [s]; clipped to [0, duration].

        Returns:
            Joint positions, velocities and accelerations, each of shape (dof,) or (m, dof).

        Raises:
            InvalidRequest: A time is not a finite number.
        """
        from ikplan.plans.playback import evaluate

        return evaluate(self, t)

    def save(
        self,
        path: str | Path,
        format: str | None = None,
        *,
        robot: Robot | None = None,
        tolerance: float | None = None,
    ) -> None:
        """Write the plan to a file.

        Args:
            path: The file.
            format: "json", "csv", "npz", "ros", "ros-goal", "urscript", "rapid", "krl", "fanuc-ls",
                "drl", "xarm" or "franky"; None: the one that the suffix names (.json, .csv, .npz,
                .ros.json, .goal.yaml, .script, .mod, .src, .ls, .drl, .xarm.py, .franky.py).
            robot: The robot with its tool, for programs of few points (RAPID, KRL, FANUC, DRL,
                xArm, franky); None: the catalogue's, without a tool.
            tolerance: How far such a program may be from the plan's path [m]; None: 0.1 mm.

        Raises:
            InvalidRequest: No such format, or the format cannot hold a plan for this robot.
            OSError: The file cannot be written.
        """
        from ikplan.plans.export import save

        save(self, Path(path), format, robot=robot, tolerance=tolerance)

    def plot(
        self,
        path: str | Path | None = None,
        scene: Mapping[str, Any] | Scene | None = None,
        *,
        axes: Any = None,
    ) -> Figure:
        """Draw joint positions, velocities against their limits, clearance, and the tool's path.

        Args:
            path: Image file; the suffix (png, svg, pdf) names the format. None: none is written.
            scene: The scene of the request, to draw obstacles and the clearance to them; for
                robots of the catalogue.
            axes: Axes of Matplotlib to draw into, in the style that holds there: one for the joint
                positions, or two for positions and velocities. None: a new figure of all.

        Returns:
            The figure; a notebook shows it.

        Raises:
            InvalidRequest: No image can be written with that suffix, the scene is wrong, or there
                are more than two axes.
            RobotNotFound: With a scene, the robot is not in the catalogue.
        """
        from ikplan.plans.figures.curves import draw_curves
        from ikplan.plans.figures.plan import check_image_suffix, draw_plan, save_figure

        if path is not None:
            check_image_suffix(path)
        if axes is not None:
            figure = draw_curves(self, axes)
        elif scene is None:
            figure = draw_plan(self)
        else:
            from ikplan.documents import parse
            from ikplan.documents.scene import Scene
            from ikplan.robots import catalogue_robot
            from ikplan.scene.model import collision_model
            from ikplan.scene.resolve import resolve_scene

            resolved = resolve_scene(parse(Scene, scene), Path.cwd())
            model = collision_model(catalogue_robot(self.robot), resolved)
            figure = draw_plan(self, model=model)
        if path is not None:
            save_figure(figure, path)
        return figure

    def plot_timing(
        self, path: str | Path, limits: Mapping[str, Any] | LimitOptions | None = None
    ) -> None:
        """Draw what the motion uses of its limits, the tool's speed and the phase plane.

        Args:
            path: Image file; the suffix (png, svg, pdf) names the format.
            limits: The limits of the request, which a plan does not tell; None: the robot's own.
        """
        from ikplan.plans.figures.timing import plot_timing

        plot_timing(self, Path(path), limits=limits)

    def show(
        self,
        scene: Mapping[str, Any] | Scene | None = None,
        *,
        tool: Mapping[str, Any] | ToolFrame | None = None,
        robot: Robot | None = None,
        meshes: bool = True,
        height: int = 420,
    ) -> Viewer:
        """Show the moving arm in the scene of the service's page: in a notebook, or as a file.

        Args:
            scene: The scene of the request, to draw obstacles and what is carried.
            tool: The tool of the request; None: the robot's own.
            robot: The robot; None: the catalogue's.
            meshes: Whether the document holds the robot's meshes (a few MB for most robots);
                False: the arm is drawn by its joints.
            height: Height in a notebook [pixels].

        Returns:
            What a notebook shows as a frame; ``save`` writes it as one HTML file, which asks for
            nothing else.

        Raises:
            InvalidRequest: The scene, the tool or the robot is wrong, or the page has not been
                built in this checkout.
            RobotNotFound: The robot is not in the catalogue.
        """
        from ikplan.plans.viewer import view_plan

        return view_plan(self, scene, tool, robot, meshes=meshes, height=height)

    def to_dataframe(self) -> DataFrame:
        """Return the samples as a DataFrame of pandas: columns ``q joint``, ``dq joint``, ...

        The index is the time [s]; units are in ``attrs["units"]``, by column.

        Raises:
            InvalidRequest: pandas is not installed.
        """
        from ikplan.plans.tables import samples_frame

        return samples_frame(self)

    def __repr__(self) -> str:
        """Return the plan in one line: a plan holds some ten thousand numbers."""
        return (
            f"Plan({self.robot!r}, {len(self.waypoints.time)} waypoints, "
            f"{self.duration:.3f} s, id={self.id!r})"
        )

    def __str__(self) -> str:
        """Return the same line, for ``print``."""
        return repr(self)

    def __rich_repr__(self) -> Iterator[Any]:
        """Tell rich the same."""
        yield self.robot
        yield "waypoints", len(self.waypoints.time)
        yield "duration", self.duration
        yield "id", self.id

    def _repr_html_(self) -> str:
        """Return the certificate and the figure, as a notebook shows them."""
        from ikplan.plans.tables import html_summary

        return html_summary(self)

    @classmethod
    def load(cls, document: Mapping[str, Any] | str | bytes) -> Plan:
        """Read a plan back from its JSON document or mapping."""
        if isinstance(document, str | bytes):
            return cls.model_validate_json(document)
        return cls.model_validate(document)
