"""A waypoint missed by more than the tolerance is found, by however little more."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from ikplan import CertificateViolated
from ikplan.certificate import certify
from ikplan.documents.path import PathRequest

from .slides import claim, slide, through, wheel

SHARES = [0.5, 0.999, 1.001, 1.5, 2.0, 4.0]


def quaternion(angle: float) -> list[float]:
    """A turn about z."""
    return [0.0, 0.0, math.sin(0.5 * angle), math.cos(0.5 * angle)]


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("direction", [(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8)])
@pytest.mark.parametrize("row", [0, 1])
def test_a_position_is_missed_from_the_tolerance_on(
    share: float, direction: tuple[float, float, float], row: int
) -> None:
    tolerance = 1e-3
    asked = np.array([[0.2, 0.0, 0.0], [0.1, 0.0, 0.0]])
    asked[row] += share * tolerance * np.array(direction)
    path = through(*({"position": list(p)} for p in asked), tolerance={"position": tolerance})
    made = claim(slide, 0.0, 0.2, 0.1, path=path)
    if share <= 1.0:
        certificate = certify(made)
        assert certificate.max_position_error == pytest.approx(share * tolerance, rel=1e-9)
        assert certificate.max_orientation_error is None
        return
    with pytest.raises(CertificateViolated, match=f"waypoint {row} is missed by") as caught:
        certify(made)
    assert len(caught.value.violations) == 1
    told = caught.value.certificate["max_position_error"]
    assert told == pytest.approx(share * tolerance, rel=1e-9)


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_an_orientation_is_missed_from_the_tolerance_on(share: float, sign: float) -> None:
    tolerance, q = 0.01, 0.3
    pose = {
        "position": [0.4 * math.cos(q), 0.4 * math.sin(q), 0.0],
        "quaternion_xyzw": quaternion(q + sign * share * tolerance),
    }
    made = claim(wheel, 0.0, q, path=through(pose, tolerance={"orientation": tolerance}))
    if share <= 1.0:
        told = certify(made).max_orientation_error
    else:
        with pytest.raises(CertificateViolated, match="waypoint 0 is missed by") as caught:
            certify(made)
        assert len(caught.value.violations) == 1
        told = caught.value.certificate["max_orientation_error"]
    assert told == pytest.approx(share * tolerance, rel=1e-9)


def test_the_least_motion_counts_what_both_ends_of_a_way_were_missed_by() -> None:
    """There and back again, each time 50 mm short: the slide cannot have moved less."""
    path = through(
        {"position": [0.4, 0, 0]}, {"position": [-0.4, 0, 0]}, tolerance={"position": 0.1}
    )
    certificate = certify(claim(slide, 0.0, 0.35, -0.35, path=path))
    assert certificate.elongation_sum == pytest.approx(0.35 + 0.7, rel=1e-12)
    assert certificate.elongation_lower_bound == pytest.approx(0.35 + 0.7, rel=1e-9)
    assert certificate.elongation_lower_bound <= certificate.elongation_sum


def test_the_least_turning_counts_what_both_ends_of_a_way_were_missed_by() -> None:
    def asked(angle: float, reached: float) -> dict[str, Any]:
        position = [0.4 * math.cos(reached), 0.4 * math.sin(reached), 0.0]
        return {"position": position, "quaternion_xyzw": quaternion(angle)}

    path = through(asked(0.4, 0.35), asked(-0.4, -0.35), tolerance={"orientation": 0.1})
    certificate = certify(claim(wheel, 0.0, 0.35, -0.35, path=path))
    assert certificate.elongation_sum == pytest.approx(0.35 + 0.7, rel=1e-12)
    assert certificate.elongation_lower_bound == pytest.approx(0.35 + 0.7, rel=1e-9)
    assert certificate.elongation_lower_bound <= certificate.elongation_sum


@pytest.mark.parametrize("off", [0.0, 5e-10, -2e-9, 1e-6, 5e-4])
def test_joint_values_asked_for_are_met_but_for_rounding(off: float) -> None:
    """Although the tool is within its tolerance of 1 mm."""
    document = {"segments": [{"type": "joint", "q": [0.2]}], "tolerance": {"position": 1e-3}}
    made = claim(slide, 0.0, 0.2 + off, path=PathRequest.model_validate(document))
    if abs(off) <= 1e-9:
        assert certify(made).valid
        return
    with pytest.raises(CertificateViolated) as caught:
        certify(made)
    words = f"the joint values of waypoint 0 are missed by {abs(off):.3g}"
    assert caught.value.violations == [words]
