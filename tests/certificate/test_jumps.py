"""A sample that the acceleration limit does not let the arm come to is a jump."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from ikplan import CertificateViolated
from ikplan.certificate import Claim, certify

from .slides import RATE, A, claim, slide

DT = 1.0 / RATE
CRUISE = 40
"""A sample within the part of constant speed."""
FREE, JUMPS = [0.5, 0.98], [1.02, 1.5, 3.0, 4.9]


def cruising() -> Claim:
    made = claim(slide, 0.0, 0.4)
    assert not made.ddq[CRUISE - 2 : CRUISE + 5].any()
    return made


def moved(field: str, by: float, where: slice | int = CRUISE) -> Claim:
    made = cruising()
    values = getattr(made, field).copy()
    values[where] += by
    return replace(made, **{field: values})


def violations(made: Claim) -> list[str]:
    try:
        certify(made)
    except CertificateViolated as error:
        return list(error.violations)
    return []


def test_the_motion_itself_is_one() -> None:
    certificate = certify(cruising())
    assert certificate.velocity_limit_ratio <= 1.0
    assert certificate.acceleration_limit_ratio <= 1.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("share", FREE + JUMPS)
def test_a_position_jumps_from_half_a_t_squared_on(share: float, sign: float) -> None:
    """From constant speed, an acceleration of a moves a joint by a t^2 / 2 within a step."""
    found = violations(moved("q", sign * share * 0.5 * A * DT**2))
    assert any("positions jump" in words for words in found) == (share > 1.0)
    assert len(found) == int(share > 1.0)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("share", FREE + JUMPS)
def test_a_velocity_jumps_from_a_t_on(share: float, sign: float) -> None:
    found = violations(moved("dq", sign * share * A * DT))
    assert any("velocities jump" in words for words in found) == (share > 1.0)


@pytest.mark.parametrize("share", FREE + JUMPS)
def test_a_waypoint_between_samples_is_as_near_as_the_acceleration_lets_it_be(share: float) -> None:
    """Half way between two samples: a (t / 2)^2 / 2 to either side of where the speed leads."""
    made = cruising()
    middle = 0.5 * (made.time[CRUISE] + made.time[CRUISE + 1])
    q = 0.5 * (made.q[CRUISE] + made.q[CRUISE + 1]) + share * 0.5 * A * (0.5 * DT) ** 2
    through = replace(
        made,
        waypoint_q=np.vstack([q[None], made.waypoint_q]),
        waypoint_time=np.concatenate([[middle], made.waypoint_time]),
    )
    found = violations(through)
    assert found == ([] if share < 1.0 else ["a waypoint is not passed at its time"])


@pytest.mark.parametrize("share", FREE + JUMPS)
def test_a_hidden_jump_to_elsewhere_is_found_at_its_two_ends_only(share: float) -> None:
    """All samples from one on are elsewhere, and the last waypoint with them."""
    by = share * 0.5 * A * DT**2
    made = moved("q", by, slice(CRUISE, None))
    found = violations(replace(made, waypoint_q=made.waypoint_q + by))
    assert found == ([] if share < 1.0 else ["positions jump between samples"])
