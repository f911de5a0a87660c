"""A path left by more than the tolerance, between waypoints that are met, is found."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from ikplan import CertificateViolated
from ikplan.certificate import certify
from ikplan.documents.path import PathRequest

from .slides import claim, gantry, turntable

TOLERANCE = {"position": 1e-3, "orientation": 0.01}
ROBOTS: dict[str, tuple[Any, str, str]] = {
    "position": (gantry, "max_path_deviation", "m"),
    "orientation": (turntable, "max_orientation_deviation", "rad"),
}


@pytest.mark.parametrize("kind", ROBOTS)
@pytest.mark.parametrize("share", [0.5, 0.999, 1.001, 1.5, 4.0])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_path_is_left_from_the_tolerance_on(kind: str, share: float, sign: float) -> None:
    """Half way along a line of 0.2 m the second joint is off by a share of the tolerance."""
    robot, figure, unit = ROBOTS[kind]
    end = {"position": [0.2, 0.0, 0.0], "quaternion_xyzw": [0.0, 0.0, 0.0, 1.0]}
    document = {"segments": [{"type": "line", "to": end}], "tolerance": TOLERANCE}
    off = share * TOLERANCE[kind]
    path = PathRequest.model_validate(document)
    made = claim(robot, (0.0, 0.0), (0.1, sign * off), (0.2, 0.0), path=path)
    middle = float(made.waypoint_time[0])
    made = replace(made, waypoint_q=made.waypoint_q[1:], waypoint_time=made.waypoint_time[1:])
    if share <= 1.0:
        certificate = certify(made).model_dump()
    else:
        with pytest.raises(CertificateViolated) as caught:
            certify(made)
        certificate = caught.value.certificate
        assert caught.value.violations == [f"the path is left by {off:.3g} {unit}"]
    assert certificate[figure] == pytest.approx(off, rel=1e-6)
    assert certificate[f"{figure}_time"] == pytest.approx(middle, abs=1e-9)
