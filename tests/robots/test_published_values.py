"""The test values of the papers' robots, and each paper's formula as an oracle."""

from __future__ import annotations

import numpy as np
import pytest

from ikplan.robots import load_robot

DEG = np.pi / 180

PUBLISHED = {
    "iiwa14": (
        np.arange(10, 80, 10) * DEG,
        [
            [-0.856945, -0.508821, -0.082137],
            [0.354714, -0.697847, 0.622244],
            [-0.373930, 0.504094, 0.778502],
        ],
        [0.050589, -0.041393, 1.216858],
    ),
    "mh5": (
        np.arange(10, 70, 10) * DEG,
        [
            [0.437547, 0.766920, -0.469454],
            [0.577151, 0.160819, 0.800646],
            [0.689528, -0.621266, -0.372263],
        ],
        [0.517889, 0.134568, 0.773304],
    ),
    "eod_arm": (
        np.arange(1, 7) * 0.1,
        [
            [-0.031610, -0.922734, 0.384139],
            [0.394502, -0.364645, -0.843446],
            [0.918351, 0.124882, 0.375547],
        ],
        [-0.796695115, -0.223299050, -0.060776455],
    ),
    "baxter_table7": (
        np.arange(1, 8) * 0.1,
        [
            [-0.525634, 0.764433, 0.373297],
            [0.797755, 0.290523, 0.528378],
            [0.295458, 0.575533, -0.762539],
        ],
        [0.718114636, 0.324866385, -0.252124759],
    ),
    "baxter_physical": (
        np.arange(1, 8) * 0.1,
        [
            [-0.525634, 0.764433, 0.373297],
            [0.797755, 0.290523, 0.528378],
            [0.295458, 0.575533, -0.762539],
        ],
        [0.793656936, 0.263097490, -0.252121708],
    ),
}


@pytest.mark.parametrize("name", PUBLISHED)
def test_pose_is_the_published_one(name: str) -> None:
    q, rotation, position = PUBLISHED[name]
    T_base_tool = load_robot(name).fk(q)
    np.testing.assert_allclose(T_base_tool.rotation, rotation, atol=1e-6, rtol=0)
    np.testing.assert_allclose(T_base_tool.translation, position, atol=1e-6, rtol=0)


@pytest.mark.parametrize(
    ("name", "position"),
    [
        ("iiwa14", [0, 0, 1.306]),
        ("mh5", [0.4795, 0, 0.680]),
        ("eod_arm", [-0.7999, -0.1496, 0.2238]),
        ("baxter_table7", [0.968169, 0.069, 0.19135]),
        ("baxter_physical", [1.037165, 0, 0.19135]),
    ],
)
def test_zero_pose_is_the_published_one(name: str, position: list[float]) -> None:
    robot = load_robot(name)
    T_base_tool = robot.fk(np.zeros(robot.dof))
    np.testing.assert_allclose(T_base_tool.translation, position, atol=1e-6, rtol=0)


def _dh(theta: float, d: float, a: float, alpha: float) -> np.ndarray:
    c, s, ca, sa = np.cos(theta), np.sin(theta), np.cos(alpha), np.sin(alpha)
    return np.array(
        [[c, -s * ca, s * sa, a * c], [s, c * ca, -c * sa, a * s], [0, sa, ca, d], [0, 0, 0, 1]]
    )


def test_iiwa_is_the_product_of_its_dh_matrices() -> None:
    d = [0.36, 0, 0.42, 0, 0.4, 0, 0.126]
    alpha = np.array([-90, 90, 90, -90, -90, 90, 0]) * DEG
    robot = load_robot("iiwa14")
    rng = np.random.default_rng(1)
    for _ in range(20):
        q = robot.random_configuration(rng)
        T = np.linalg.multi_dot([_dh(q[i], d[i], 0, alpha[i]) for i in range(7)])
        np.testing.assert_allclose(robot.fk(q).homogeneous, T, atol=1e-13)


def test_mh5_is_its_modified_dh_table_turned_to_the_flange() -> None:
    rows = [(0, 0, 0.33), (-90, 0.088, 0), (0, 0.31, 0), (-90, 0.04, 0.305), (90, 0, 0)]
    rows.append((-90, 0, 0.0865))
    robot = load_robot("mh5")
    rng = np.random.default_rng(2)
    for _ in range(20):
        q = robot.random_configuration(rng)
        theta = np.array([q[0], q[1] - np.pi / 2, -q[2], -q[3], -q[4], -q[5]])
        # Modified DH: Rx(alpha) Tx(a) is a standard row of its own, before Rz(theta) Tz(d).
        T = np.eye(4)
        for (alpha, a, d), angle in zip(rows, theta, strict=True):
            T = T @ _dh(0, 0, a, alpha * DEG) @ _dh(angle, d, 0, 0)
        flange = robot.fk(q)
        columns = np.column_stack(
            [flange.rotation[:, 2], -flange.rotation[:, 1], flange.rotation[:, 0]]
        )
        np.testing.assert_allclose(T[:3, :3], columns, atol=1e-13)
        np.testing.assert_allclose(T[:3, 3], flange.translation, atol=1e-13)


def test_mh5_tool0_is_the_flange_turned() -> None:
    q = np.arange(6) * 0.1
    flange, tool0 = load_robot("mh5").fk(q), load_robot("mh5", tip="tool0").fk(q)
    np.testing.assert_allclose(tool0.translation, flange.translation, atol=1e-15)
    np.testing.assert_allclose(tool0.rotation[:, 2], flange.rotation[:, 0], atol=1e-12)


def test_dobot_is_the_papers_formula() -> None:
    robot = load_robot("dobot_magician")
    rng = np.random.default_rng(3)
    for _ in range(50):
        q = robot.random_configuration(rng)
        t1, t2, t3, t4 = q
        r = 0.135 * np.sin(t2) + 0.147 * np.cos(t3) + 0.061
        z = 0.135 * np.cos(t2) - 0.147 * np.sin(t3) + 0.058
        T = robot.fk(q)
        np.testing.assert_allclose(T.translation, [r * np.cos(t1), r * np.sin(t1), z], atol=1e-14)
        yaw = t1 - t4
        c, s = np.cos(yaw), np.sin(yaw)
        np.testing.assert_allclose(T.rotation, [[c, -s, 0], [s, c, 0], [0, 0, 1]], atol=1e-14)


def test_dobot_inverse_rounds_to_every_angle_of_the_papers_circle() -> None:
    theta1 = [34.8, 38.7, 42.9, 47.1, 51.3, 55.2, 58.6, 61.2, 62.8, 62.8]
    theta1 += [60.6, 56.0, 49.0, 41.0, 34.0, 29.4, 27.2, 27.2, 28.8, 31.4]
    theta2 = [66.5, 69.6, 71.4, 71.4, 69.6, 66.5, 62.6, 58.4, 54.6, 51.5]
    theta2 += [49.5, 48.8, 48.8, 48.8, 48.8, 49.5, 51.5, 54.6, 58.4, 62.6]
    theta3 = [49.5, 45.6, 43.5, 43.5, 45.6, 49.5, 54.8, 61.1, 68.0, 75.2]
    theta3 += [82.2, 88.3, 92.0, 92.0, 88.3, 82.2, 75.2, 68.0, 61.1, 54.8]
    robot = load_robot("dobot_magician")
    for k in range(20):
        phi = 18 * k * DEG
        x, y = 0.16 + 0.07 * np.cos(phi), 0.16 + 0.07 * np.sin(phi)
        rho, h = np.hypot(x, y) - 0.061, -0.058
        # Elbow triangle with the sides 0.135 and 0.147 to the point (rho, h).
        reach = np.hypot(rho, h)
        inner = np.arccos((0.135**2 + reach**2 - 0.147**2) / (2 * 0.135 * reach))
        t2 = np.pi / 2 - (np.arctan2(h, rho) + inner)
        t3 = np.arctan2(0.135 * np.cos(t2) - h, rho - 0.135 * np.sin(t2))
        t1 = np.arctan2(y, x)
        exact = np.array([t1, t2, t3, t1])
        np.testing.assert_allclose(robot.fk(exact).translation, [x, y, 0], atol=1e-12)
        np.testing.assert_allclose(robot.fk(exact).rotation, np.eye(3), atol=1e-12)
        table = [theta1[k], theta2[k], theta3[k], theta1[k]]
        assert np.abs(exact / DEG - table).max() < 0.05
        assert (robot.lower <= exact).all()
        assert (exact <= robot.upper).all()
