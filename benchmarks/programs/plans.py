"""Random plans of arms as their controllers get them: no rate, no jerk in the request."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Literal

import numpy as np

import ikplan
from benchmarks.requests.drawing import draw
from ikplan.errors import CertificateViolated, IkplanError
from ikplan.pipeline.retime import time_request
from ikplan.plans.plan import Plan
from ikplan.robots import load_robot

__all__ = ["random_plans", "short_timings"]

Kind = Literal["plan", "timing"]
_KINDS: tuple[Kind, ...] = ("plan", "timing")


def random_plans(
    robots: Sequence[str], seed: int, budget_s: float = 20.0, kinds: Sequence[Kind] = _KINDS
) -> Iterator[Plan]:
    """Yield plans and timings of random requests, refused ones left out, without end.

    A broken certificate is no refusal: it is raised.

    Args:
        robots: Names of the robots to draw from.
        seed: Which series.
        budget_s: Time budget of each request [s].
        kinds: Plans of paths, timings of joint paths, or both by turns.
    """
    number = 0
    while True:
        kind = kinds[number % len(kinds)]
        request = draw(kind, seed, number // len(kinds), budget_s, robots)
        number += 1
        request.pop("sampling", None)
        request["limits"].pop("jerk", None)
        try:
            yield time_request(request) if kind == "timing" else ikplan.plan(request)
        except CertificateViolated:
            raise
        except IkplanError:
            continue


def short_timings(robots: Sequence[str], seed: int) -> Iterator[Plan]:
    """Yield timings of short joint paths near the homes of robots, without end.

    Args:
        robots: Names of the robots, by turns.
        seed: Which series.
    """
    rng = np.random.default_rng(seed)
    for name in itertools.cycle(robots):
        robot = load_robot(name)
        steps = rng.uniform(-0.3, 0.3, (int(rng.integers(1, 6)), robot.dof))
        path = robot.home + np.vstack([0.0 * robot.home, np.cumsum(steps, axis=0)])
        path = np.clip(path, robot.lower, robot.upper)
        limits = {"velocity_scale": float(rng.uniform(0.2, 1.0))}
        yield time_request({"robot": name, "waypoints": path.tolist(), "limits": limits})
