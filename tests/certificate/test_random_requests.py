"""A seeded sample of ``python -m benchmarks.requests --between 10``: no plan is off its path."""

from __future__ import annotations

import pytest

import ikplan
from benchmarks.requests.between import as_polynomial, share_between
from benchmarks.requests.drawing import draw
from ikplan import CertificateViolated, IkplanError

BUDGET_S = 20.0


@pytest.mark.parametrize("kind", ["plan", "curve"])
def test_a_random_request_ends_in_a_plan_on_its_path_or_in_a_refusal(kind: str) -> None:
    planned = 0
    for number in range(12):
        request = as_polynomial(draw(kind, 2026, number, BUDGET_S))
        try:
            plan = ikplan.plan(request)
        except CertificateViolated:
            raise
        except IkplanError:
            continue
        assert share_between(request, plan, 5) <= 1.0, f"{kind} {number}"
        planned += 1
    assert planned >= 1


@pytest.mark.parametrize(
    ("kind", "seed", "number"),
    [
        ("curve", 702, 714),  # the tool turns by half a turn within a micrometre
        ("curve", 702, 747),  # a narrow helix within a wide box, about a free axis
        ("curve", 601, 232),  # a box that turns with a fast tool
    ],
)
def test_a_request_that_was_once_refused_by_the_certificate_is_planned(
    kind: str, seed: int, number: int
) -> None:
    request = as_polynomial(draw(kind, seed, number, 60.0))
    assert share_between(request, ikplan.plan(request), 2) <= 1.0
