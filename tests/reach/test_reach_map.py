"""Reach maps: held to Pinocchio, to closed forms, and to what a scene forbids."""

import math
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

import ikplan
from ikplan.cli import main
from ikplan.errors import InvalidRequest
from ikplan.reach.poses import grid_positions, spread_orientations
from ikplan.reach.save import draw_reach_map


def test_a_grid_has_its_corners_and_its_spacing() -> None:
    grid = grid_positions([0.0, -0.1, 0.3], [0.3, 0.1, 0.3], 0.1)
    assert grid.shape == (12, 3)
    assert np.allclose(grid[0], [0.0, -0.1, 0.3])
    assert np.allclose(grid[-1], [0.3, 0.1, 0.3])
    assert len(np.unique(grid, axis=0)) == 12


def test_orientations_are_rotations_spread_over_their_cone() -> None:
    R = spread_orientations(200, 3)
    assert R.shape == (600, 3, 3)
    assert np.allclose(R @ R.transpose(0, 2, 1), np.eye(3), atol=1e-12)
    assert np.allclose(np.linalg.det(R), 1.0)
    # Spread evenly: the mean of the axes is near zero, that of their squares a third.
    z = R[:, :, 2]
    assert np.abs(z.mean(axis=0)).max() < 0.02
    assert np.allclose((z * z).mean(axis=0), 1.0 / 3.0, atol=0.02)
    cone = spread_orientations(50, 1, toward=[1.0, 0.0, 0.0], within=0.3)
    lean = np.arccos(cone[:, 0, 2])
    assert lean.max() <= 0.3
    assert lean.max() > 0.28
    assert spread_orientations(1, 1)[0, :, 2] == pytest.approx([0.0, 0.0, -1.0])


def test_reached_poses_are_met_by_pinocchio_and_far_ones_are_not() -> None:
    robot = ikplan.load_robot("ur5")
    positions = [[0.4, 0.1, 0.4], [3.0, 0.0, 0.0], [0.5, -0.2, 0.2]]
    found = ikplan.reach_map(robot, positions, spread_orientations(12, 2))
    assert found.reached.shape == (3, 24)
    assert found.share[1] == 0.0
    assert found.share[0] > 0.9
    for m, n in np.argwhere(found.reached)[::5]:
        pose = pin.SE3(found.rotations[n], found.positions[m])
        q = found.q[m, n]
        assert np.linalg.norm(pin.log6(robot.fk(q).actInv(pose)).vector) < 1e-6
        assert found.manipulability[m, n] == pytest.approx(abs(np.linalg.det(robot.jacobian(q))))
    assert np.isnan(found.q[1]).all()
    assert np.isnan(found.manipulability[1]).all()
    assert found.clearance is None
    again = ikplan.reach_map(robot, positions, spread_orientations(12, 2), threads=1)
    assert np.array_equal(again.q, found.q, equal_nan=True)


def test_what_a_scene_forbids_is_in_contact_and_the_rest_keeps_its_clearance() -> None:
    robot = ikplan.load_robot("ur5")
    wall = {"name": "wall", "shape": {"type": "box", "size": [0.02, 4.0, 4.0]}}
    scene = {"obstacles": [{**wall, "position": [0.6, 0.0, 0.0]}]}
    positions = [[0.4, 0.1, 0.4], [0.6, 0.0, 0.3]]
    rotations = spread_orientations(10, 1)
    free = ikplan.reach_map(robot, positions, rotations)
    found = ikplan.reach_map(robot, positions, rotations, scene=scene)
    assert not found.reached[1].any()
    assert np.array_equal(found.in_contact[1], free.reached[1])
    assert (found.reached <= free.reached).all()
    assert found.reached[0].any()
    assert found.clearance is not None
    for n in np.flatnonzero(found.reached[0]):
        assert found.clearance[0, n] == pytest.approx(
            robot.clearance(found.q[0, n], scene).distance, abs=1e-6
        )


def test_the_command_writes_the_map_and_its_figure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    table, figure = tmp_path / "map.parquet", tmp_path / "map.svg"
    corners = ["--lower", "0.3", "-0.1", "0.3", "--upper", "0.5", "0.1", "0.3"]
    shape = ["--spacing", "0.1", "--directions", "3", "--within", "40", "--self-collision"]
    assert main(["reach", "ur5", *corners, *shape, "-o", str(table), "--plot", str(figure)]) == 0
    assert "of 27 poses are reached" in capsys.readouterr().out
    rows = parquet.read_table(table).to_pylist()
    assert len(rows) == 27
    robot = ikplan.load_robot("ur5")
    for row in rows:
        if row["reached"]:
            quaternion = pin.Quaternion(np.array([row[k] for k in ("qx", "qy", "qz", "qw")]))
            wanted = pin.SE3(quaternion, np.array([row["x"], row["y"], row["z"]]))
            assert robot.fk(row["q"]).isApprox(wanted, 1e-6)
            assert row["clearance"] > 0.0
        else:
            assert row["q"] is None
    drawn = figure.read_bytes()
    found = ikplan.reach_map(
        robot,
        grid_positions([0.3, -0.1, 0.3], [0.5, 0.1, 0.3], 0.1),
        spread_orientations(3, 1, within=math.radians(40.0)),
        scene={},
    )
    draw_reach_map(found, figure)
    assert figure.read_bytes() == drawn


@pytest.mark.parametrize(
    ("options", "field"),
    [
        (["--spacing", "0"], "spacing"),
        (["--spacing", "1e-4"], "spacing"),
        (["--directions", "0"], "directions"),
        (["--within", "200"], "within"),
        (["--toward", "0", "0", "0"], "toward"),
        (["--lower", "9", "9", "9"], "upper"),
        (["-o", "map.csv", "--spacing", "1", "--directions", "1"], "output"),
    ],
)
def test_what_makes_no_sense_is_refused(
    options: list[str], field: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["reach", "ur5", *options]) == 2
    assert field in capsys.readouterr().err


def test_a_grid_without_end_is_refused() -> None:
    with pytest.raises(InvalidRequest, match="three finite numbers"):
        grid_positions([0.0, 0.0, 0.0], [math.inf, 1.0, 1.0], 0.1)
