"""Many targets of one arm by Levenberg-Marquardt, on some threads."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numba
import numpy as np

from ikplan._kernels.clock import working_seconds
from ikplan.arrays import Array, Flags
from ikplan.ik.poses.arrays import PoseArrays
from ikplan.ik.poses.kernels import solve_lm_batch
from ikplan.kinematics.arm import Arm
from ikplan.kinematics.target import no_freedom

__all__ = ["beyond_shoulder", "solve_batch", "thread_count"]

_SLICE = 1024
"""Poses between two looks at the clock: some 10 ms."""
_SEEDS = 200_000
"""Most seeds between two looks at the clock: a second, if no pose is reached."""
_LEAST = 64
"""Fewest poses that are worth a thread."""


def thread_count() -> int:
    """Return how many threads a batch of poses takes; ``NUMBA_NUM_THREADS`` bounds it."""
    return int(numba.config.NUMBA_NUM_THREADS)


def beyond_shoulder(
    arm: Arm, poses: PoseArrays, tolerance_position: float, tolerance_orientation: float
) -> Flags:
    """Return which poses no configuration reaches, by the distance of the wrist from the shoulder.

    Args:
        arm: The arm; without a shoulder or a spherical wrist nothing is known.
        poses: The poses, n.
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].

    Returns:
        Shape (n,).
    """
    if arm.wrist is None or arm.shoulder is None or not poses.oriented:
        return np.zeros(len(poses.p), dtype=np.bool_)
    lever = arm.wrist.tool_to_centre
    distance = np.linalg.norm(poses.p + poses.R @ lever - arm.shoulder.centre, axis=1)
    slack = tolerance_position + tolerance_orientation * float(np.linalg.norm(lever)) + 1e-9
    near, far = arm.shoulder.nearest - slack, arm.shoulder.farthest + slack
    beyond: Flags = (distance < near) | (distance > far)
    return beyond


def solve_batch(
    arm: Arm,
    poses: PoseArrays,
    q_start: Array,
    tolerance_position: float,
    tolerance_orientation: float,
    restarts: int,
    iterations: int,
    seed: int,
    *,
    threads: int,
    check: Callable[[int, float], None],
) -> tuple[Array, Array]:
    """Solve poses, each as the method lm does alone.

    Args:
        arm: The arm.
        poses: The poses, n.
        q_start: Where each begins, shape (n, dof), or (1, dof) for all [rad or m].
        tolerance_position: Distance that counts as solved [m].
        tolerance_orientation: Angle that counts as solved [rad].
        restarts: Number of further seeds of each.
        iterations: Largest number of steps from one seed.
        seed: Shifts the restart sequence.
        threads: Largest number of threads.
        check: Is called now and then with the number of poses of a part that is done and its
            share of the processor time of all other threads [s], and may raise to end the batch.

    Returns:
        Solutions, or the best configurations found, shape (n, dof) [rad or m]; distance [m],
        rotation angle [rad] and evaluations of each, shape (n, 3).
    """
    count = len(poses.p)
    q, errors = np.empty((count, arm.dof)), np.empty((count, 3))
    lower, upper = (
        np.ascontiguousarray(np.broadcast_to(bound, q_start.shape))
        for bound in arm.search_bounds(q_start)
    )
    freedom, single = no_freedom(), len(q_start) == 1

    def part(first: int, last: int) -> int:
        rows = slice(first, last)
        starts = slice(None) if single else rows
        solve_lm_batch(
            arm.chain,
            freedom,
            poses.R[rows] if poses.oriented else poses.R,
            poses.p[rows],
            poses.oriented,
            q_start[starts],
            lower[starts],
            upper[starts],
            tolerance_position,
            tolerance_orientation,
            restarts,
            iterations,
            seed,
            q[rows],
            errors[rows],
        )
        return last - first

    threads = max(1, min(threads, count // _LEAST))
    # Small enough that all threads end at about the same time.
    most = min(_SLICE, max(1, _SEEDS // (restarts + 1)))
    size = max(1, min(most, -(-count // (4 * threads))))
    parts = [(k, min(k + size, count)) for k in range(0, count, size)]
    if threads == 1:
        for first, last in parts:
            check(part(first, last), 0.0)
        return q, errors

    def timed(first: int, last: int) -> tuple[int, float]:
        begin = working_seconds()
        return part(first, last), (working_seconds() - begin) / threads

    with ThreadPoolExecutor(threads) as pool:
        running = [pool.submit(timed, *bounds) for bounds in parts]
        try:
            for done in running:
                check(*done.result())
        finally:
            for done in running:
                done.cancel()
    return q, errors
