from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from mpl_toolkits.mplot3d.art3d import Line3D

import ikplan
from ikplan import InvalidRequest, Plan
from ikplan.plans.figures.plan import IMAGE_SUFFIXES, draw_plan, plot_plan
from ikplan.plans.summary import certificate_rows

from .plans import rest_to_rest


def plan_of(name: str) -> Plan:
    robot = ikplan.load_robot(name)
    units = tuple("m" if slides else "rad" for slides in robot.prismatic)
    plan = rest_to_rest(robot.dof, 60, units)
    return plan.model_copy(update={"robot": name, "joint_names": list(robot.joint_names)})


@pytest.mark.parametrize("suffix", IMAGE_SUFFIXES)
def test_the_same_plan_gives_the_same_image(suffix: str, tmp_path: Path) -> None:
    plan = plan_of("ur5")
    images = []
    for i in range(2):
        plan.plot(tmp_path / f"{i}{suffix}")
        images.append((tmp_path / f"{i}{suffix}").read_bytes())
    assert images[0] == images[1]
    assert len(images[0]) > 5000


def test_drawing_leaves_the_settings_of_the_program_alone(tmp_path: Path) -> None:
    before = dict(matplotlib.rcParams)
    plan_of("ur5").plot(tmp_path / "plan.png")
    assert dict(matplotlib.rcParams) == before


@pytest.mark.parametrize("name", ["plan", "plan.bmp", "plan.json"])
def test_an_unknown_image_suffix_lists_the_known(name: str, tmp_path: Path) -> None:
    with pytest.raises(InvalidRequest) as caught:
        plan_of("ur5").plot(tmp_path / name)
    assert caught.value.allowed == [".png", ".svg", ".pdf"]
    assert not list(tmp_path.iterdir())


def curves(figure: Figure, title: str) -> list[Line2D]:
    (axes,) = (a for a in figure.axes if a.get_title(loc="left") == title)
    return [line for line in axes.get_lines() if line.get_linestyle() == "-"]


def test_every_sample_of_every_joint_is_drawn() -> None:
    plan = plan_of("ur5")
    limits = ikplan.load_robot("ur5").velocity_limit
    figure = draw_plan(plan)
    positions = curves(figure, "Joint positions, dots at the waypoints")
    velocities = curves(figure, "Joint velocities over their limits")
    drawn = [line for line in positions if np.size(line.get_xdata()) == 60]
    assert len(drawn) == 6
    for j, (position, velocity) in enumerate(zip(drawn, velocities, strict=False)):
        assert np.array_equal(position.get_xdata(), plan.trajectory.time)
        assert np.allclose(position.get_ydata(), np.degrees(plan.trajectory.q[:, j]))
        assert np.allclose(velocity.get_ydata(), plan.trajectory.dq[:, j] / limits[j])


def test_the_path_is_that_of_the_tool_where_the_tool_is_known() -> None:
    plan = plan_of("ur5")
    robot = ikplan.load_robot("ur5").with_tool([0.0, 0.0, 0.2])
    for given, frame in ((None, "tip"), (robot, "tool")):
        figure = draw_plan(plan, robot=given)
        title = f"Path of the {frame} in the base frame [m]"
        (axes,) = (a for a in figure.axes if a.get_title(loc="left") == title)
        (line,) = (way for way in axes.get_lines()[:1] if isinstance(way, Line3D))
        path = np.array(line.get_data_3d()).T
        tool = given or ikplan.load_robot("ur5")
        assert np.allclose(path[0], tool.fk(plan.trajectory.q[0]).translation)


@pytest.mark.parametrize("name", ["tiago", "kinova_j2s6s200", "dobot_magician"])
def test_sliding_endless_and_coupled_joints_can_be_drawn(name: str, tmp_path: Path) -> None:
    plan_of(name).plot(tmp_path / "plan.png")
    assert (tmp_path / "plan.png").stat().st_size > 5000


def test_a_robot_that_nobody_knows_is_drawn_without_limits(tmp_path: Path) -> None:
    plot_plan(rest_to_rest(3, 9, ("rad", "m", "rad")), tmp_path / "plan.png")
    assert (tmp_path / "plan.png").stat().st_size > 5000


def test_a_plan_without_motion_can_be_drawn(tmp_path: Path) -> None:
    plan = plan_of("ur5")
    motion = plan.trajectory
    still = motion.model_copy(
        update={
            "time": motion.time[:1], "q": motion.q[:1], "dq": motion.dq[:1], "ddq": motion.ddq[:1],
        }
    )  # fmt: skip
    plan.model_copy(update={"trajectory": still}).plot(tmp_path / "plan.png")


def test_the_certificate_is_never_rounded_in_our_favour() -> None:
    plan = rest_to_rest()
    certificate = plan.certificate.model_copy(update={"velocity_limit_ratio": 1.0000001})
    rows = dict(certificate_rows(plan.model_copy(update={"certificate": certificate})))
    assert rows["velocity limits"].startswith("100.1 %")
    assert dict(certificate_rows(plan))["velocity limits"].startswith("100.0 %")
