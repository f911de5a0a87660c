"""SO(3): laws, and Pinocchio as the oracle."""

import math

import numpy as np
import pinocchio as pin
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from ikplan.path.rotation.so3 import (
    angle_between,
    exp,
    log,
    quaternion_of,
    rotation_of,
)
from ikplan.path.rotation.so3_kernels import add_right_jacobian

from .requests import Array, vectors

angles = st.one_of(
    st.floats(0.0, math.pi - 1e-6),
    st.sampled_from([0.0, 1e-300, 1e-12, 1e-8, 1e-4, 0.0099, 0.0101, math.pi - 1e-5]),
)
axes = vectors.filter(lambda v: np.linalg.norm(v) > 1e-3).map(
    lambda v: np.array(v) / np.linalg.norm(v)
)


@settings(deadline=None)
@given(axes, angles)
def test_exp_and_log_are_those_of_pinocchio_and_undo_each_other(axis: Array, angle: float) -> None:
    rotvec = axis * angle
    R = exp(rotvec)
    assert_allclose(R, pin.exp3(rotvec), atol=1e-14)
    assert_allclose(R @ R.T, np.eye(3), atol=1e-14)
    assert_allclose(log(R), rotvec, rtol=1e-12, atol=1e-14 if angle < 3.0 else 1e-9)


@settings(deadline=None)
@given(axes)
def test_a_half_turn_has_a_logarithm(axis: Array) -> None:
    turn = log(exp(math.pi * axis))
    assert np.linalg.norm(turn) == pytest.approx(math.pi, abs=1e-12)
    assert abs(turn @ axis) == pytest.approx(math.pi, abs=1e-9)


@settings(deadline=None)
@given(axes, angles)
def test_quaternions_and_matrices_tell_the_same_rotation(axis: Array, angle: float) -> None:
    R = exp(axis * angle)
    q = quaternion_of(R)
    assert q[3] >= 0.0
    assert_allclose(rotation_of(q), R, atol=1e-14)
    assert_allclose(rotation_of(-q), R, atol=1e-14)
    assert_allclose(pin.Quaternion(R).matrix(), rotation_of(q), atol=1e-14)


@settings(deadline=None)
@given(axes, st.one_of(st.floats(0.0, 3.0), st.sampled_from([0.0, 1e-9, 0.0099, 0.0101])), vectors)
def test_the_right_jacobian_is_the_rate_of_exp(
    axis: Array, angle: float, direction: tuple[float, float, float]
) -> None:
    rotvec, d, h = axis * angle, np.array(direction), 1e-6
    body = log(exp(rotvec - h * d).T @ exp(rotvec + h * d)) / (2.0 * h)
    rate, back = np.zeros(3), np.zeros(3)
    add_right_jacobian(rotvec, d, False, rate)
    assert_allclose(rate, body, atol=1e-8)
    add_right_jacobian(rotvec, rate, True, back)
    assert_allclose(back, d, atol=1e-12)


def test_stacks_are_taken_row_by_row() -> None:
    rotvecs = np.random.default_rng(0).normal(size=(4, 5, 3))
    R = exp(rotvecs)
    assert R.shape == (4, 5, 3, 3)
    assert_allclose(R[2, 3], exp(rotvecs[2, 3]), atol=1e-15)
    assert_allclose(log(R), log(rotation_of(quaternion_of(R))), atol=1e-12)
    assert_allclose(angle_between(R, R[0, 0])[0, 0], 0.0, atol=1e-15)
