"""Why a motion takes as long as it does: what binds where, and what more would bring."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ikplan.arrays import Array, Flags, Indices, steps_of
from ikplan.errors import InvalidRequest, TimingFailed
from ikplan.timing.constraints.constraints import Label, PathConstraint, PathPoints
from ikplan.timing.engines.engine import Check, EngineFailed, unlimited
from ikplan.timing.jerk.jerk import smooth_span_alike
from ikplan.timing.jerk.smoothed import Smoothed
from ikplan.timing.problem import SpanProblem
from ikplan.timing.profile import LimitProfile
from ikplan.timing.span import SpanTiming
from ikplan.timing.timed_path import TimedPath

__all__ = ["Binding", "BindingShare", "WhatIf", "binding", "what_if", "what_ifs"]

_CLEAR = 0.95
"""A limit of which less is used, as a ratio to the speed that it allows, does not bind."""


@dataclass(frozen=True)
class BindingShare:
    """How much of the time one limit binds.

    Attributes:
        limit: "velocity", "acceleration", "torque", "tool_linear_speed", ...
        joint: Name of the joint, None for a limit of the tool.
        share: Share of the duration, 0 to 1.
    """

    limit: str
    joint: str | None
    share: float


@dataclass(frozen=True, eq=False)
class Binding:
    """Which limit binds in each interval of a timing.

    Attributes:
        labels: The limits there are.
        index: The limit nearest to its bound in each interval, shape (n,).
        ratio: How near, as a ratio to the speed that it allows there, shape (n,).
        dt: Durations of the intervals [s], shape (n,).
    """

    labels: tuple[Label, ...]
    index: Indices
    ratio: Array
    dt: Array

    def summary(self) -> list[BindingShare]:
        """Return the limits that bind and the share of the time that each does, most first."""
        time = np.bincount(self.index, weights=self.dt, minlength=len(self.labels))
        total = float(time.sum())
        order = np.argsort(-time, kind="stable")
        return [
            BindingShare(self.labels[i][0], self.labels[i][1], float(time[i]) / total)
            for i in order
            if time[i] > 0.0
        ]

    def sentence(self) -> str:
        """Return the summary in words: "62 % of the time joint4 velocity, ..."."""
        parts = [
            f"{100.0 * s.share:.0f} % of the time {s.joint + ' ' if s.joint else ''}"
            + s.limit.replace("_", " ")
            for s in self.summary()
            if s.share >= 0.005
        ]
        return ", ".join(parts)


@dataclass(frozen=True)
class WhatIf:
    """What a wider limit would bring.

    Attributes:
        limit: Kind of the limit.
        joint: Name of the joint, None for a limit of the tool.
        factor: By what it was multiplied.
        duration: Duration with it [s].
        saved: What that is less than before [s].
    """

    limit: str
    joint: str | None
    factor: float
    duration: float
    saved: float


def binding(timed: TimedPath) -> Binding:
    """Find the limit that binds in each interval.

    Args:
        timed: The timing.

    Returns:
        The binding limits; of a path of length zero, none.
    """
    labels: dict[Label, int] = {}
    index, ratios, dt = [], [], []
    parts = [_jerk_ratios(timed)] if timed.jerk_limited else map(_ratios, timed.spans)
    for mine, ratio, durations in parts:
        number = np.array([labels.setdefault(label, len(labels)) for label in mine], dtype=np.int64)
        if not len(durations):
            continue
        best = np.argmax(ratio, axis=1)
        index.append(number[best])
        ratios.append(ratio[np.arange(len(best)), best])
        dt.append(durations)
    if not index:
        return Binding((), np.zeros(0, dtype=np.int64), np.zeros(0), np.zeros(0))
    return Binding(tuple(labels), np.concatenate(index), np.concatenate(ratios), np.concatenate(dt))


def _ratios(span: SpanTiming) -> tuple[list[Label], Array, Array]:
    """Return limits, how near each is in the middle of every interval, and the durations."""
    problem, x = span.problem, span.x
    u = steps_of(x) / (2.0 * problem.h)
    # In the middle of an interval, away from the switches at its ends.
    middle = 0.5 * (x[1:] + x[:-1])
    qss = 0.5 * (problem.qss0 + problem.qss1)
    qs = problem.qs0 + 0.125 * problem.h[:, None] * (3.0 * problem.qss0 + problem.qss1)
    dq = qs * np.sqrt(middle)[:, None]
    ddq = qs * u[:, None] + qss * middle[:, None]
    up, down, a_up, a_down = problem.bounds
    columns = [np.maximum(dq / up, dq / down), np.sqrt(np.maximum(ddq / a_up, ddq / a_down))]
    of_constraints = [
        (points.constraint, points.inside, ratios[len(ratios) // 2])
        for points, ratios in problem.others.ratios(x)
    ]
    more, ratio = _ratios_of(of_constraints, len(x) - 1)
    if len(problem.rests):
        problem.forget()
    return _joint_labels(problem.profile) + more, np.hstack([*columns, ratio]), span.dt


def _ratios_of(
    of_constraints: Sequence[tuple[PathConstraint, Indices, Array]], n: int
) -> tuple[list[Label], Array]:
    """Return the labels of constraints and the ratios to the speed they allow, shape (n, labels).

    Args:
        of_constraints: Constraints, the intervals in their ranges, shape (r,), and their limit
            ratios there, shape (r, labels); those of one name are one limit.
        n: Number of intervals.
    """
    labels = list(dict.fromkeys(label for c, _, _ in of_constraints for label in c.labels))
    ratio = np.zeros((n, len(labels)))
    for constraint, inside, ratios in of_constraints:
        for label, column in zip(constraint.labels, ratios.T, strict=True):
            at = labels.index(label)
            ratio[inside, at] = np.maximum(ratio[inside, at], np.sqrt(np.maximum(column, 0.0)))
    return labels, ratio


def _jerk_ratios(timed: TimedPath) -> tuple[list[Label], Array, Array]:
    """Return the same of a jerk-limited motion."""
    if timed.sddot is None or not timed.spans:
        return [], np.zeros((0, 0)), np.zeros(0)
    profile, path = timed.spans[0].problem.profile, timed.path
    dt = steps_of(timed.node_times)
    middle = timed.node_times[:-1] + 0.5 * dt
    _, dq, ddq = timed.evaluate(middle)
    # The acceleration is smooth inside an interval, but for knots of the path.
    _, _, before = timed.evaluate(middle - 0.01 * dt)
    _, _, after = timed.evaluate(middle + 0.01 * dt)
    dddq = (after - before) / np.maximum(0.02 * dt, 1e-300)[:, None]
    piece = np.clip(
        np.searchsorted(path.s_knots, 0.5 * (timed.s[1:] + timed.s[:-1]), side="right") - 1,
        0,
        len(path.s_knots) - 2,
    )
    ratio = np.hstack(
        [
            np.maximum(dq / profile.velocity[piece], dq / profile.velocity_lower[piece]),
            np.sqrt(
                np.maximum(
                    ddq / profile.acceleration[piece], ddq / profile.acceleration_lower[piece]
                )
            ),
            np.cbrt(np.abs(dddq) / profile.jerk[piece]),
        ]
    )
    jerk: list[Label] = [("jerk", name) for name in profile.joint_names]
    more, of_constraints = _ratios_of(_jerk_limited_ratios(timed, dt), len(dt))
    return _joint_labels(profile) + jerk + more, np.hstack([ratio, of_constraints]), dt


def _jerk_limited_ratios(
    timed: TimedPath, dt: Array
) -> list[tuple[PathConstraint, Indices, Array]]:
    """Return the limit ratios of constraints in mid-interval, of a jerk-limited motion."""
    path, sddot = timed.path, timed.sddot
    assert sddot is not None  # it is jerk-limited
    half, jerk = 0.5 * dt, np.zeros(len(dt))
    np.divide(steps_of(sddot), dt, out=jerk, where=dt > 0.0)
    a, v = sddot[:-1], timed.sdot[:-1]
    s = timed.s[:-1] + half * (v + half * (0.5 * a + half * jerk / 6.0))
    x, u = np.square(v + half * (a + 0.5 * half * jerk)), a + half * jerk
    found = []
    for constraint in dict.fromkeys(c for x in timed.spans for c in x.problem.constraints):
        inside = np.flatnonzero((s > constraint.start) & (s < constraint.end))
        if len(inside):
            points = PathPoints(s[inside], *path.derivatives(s[inside]), path.length)
            ratios = constraint.at(points).ratios(np.arange(len(inside)), u[inside], x[inside])
            found.append((constraint, inside, ratios))
    return found


def _joint_labels(profile: LimitProfile) -> list[Label]:
    return [(kind, name) for kind in ("velocity", "acceleration") for name in profile.joint_names]


def what_if(
    timed: TimedPath,
    limit: str,
    joint: str | None = None,
    factor: float = 1.1,
    check: Check = unlimited,
) -> WhatIf:
    """Time a motion again with one limit changed, everywhere on the path.

    The path speed is solved again on the same grid, before and after the change, and the duration
    scaled by the ratio: what the grid costs is not mistaken for what the limit brings. A
    jerk-limited motion is timed again only in the way that was best for it; another one might
    bring a little more.

    Args:
        timed: The timing.
        limit: Kind of the limit, as in its binding.
        joint: Name of the joint, None for a limit of the tool.
        factor: By what to multiply it, > 0.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The new duration.

    Raises:
        InvalidRequest: There is no such limit, or the factor is not positive.
        TimingFailed: There is no timing with a limit that is narrower.
    """
    return what_ifs(timed, [(limit, joint)], factor, check)[0]


def what_ifs(
    timed: TimedPath,
    labels: Sequence[Label],
    factor: float = 1.1,
    check: Check = unlimited,
) -> list[WhatIf]:
    """Time a motion again with one limit changed, and once more with another one.

    Args:
        timed: The timing.
        labels: The limits, as in its binding, each changed by itself.
        factor: By what to multiply them, > 0.
        check: Is called now and then, and may end the search by an error of its own.

    Returns:
        The new durations, as :func:`what_if` has them.

    Raises:
        InvalidRequest: There is no such limit, or the factor is not positive.
        TimingFailed: There is no timing with a limit that is narrower.
    """
    if not factor > 0.0 or not np.isfinite(factor):
        raise InvalidRequest(
            f"factor must be positive, not {factor!r}", field="factor", allowed="a positive number"
        )
    if not labels:
        return []
    for label in labels:
        _check_label(timed, label)
    before, after = 0.0, np.zeros(len(labels))
    bound = _bound_spans(timed, labels) if factor >= 1.0 else None
    for k, span in enumerate(timed.spans):
        known = timed.smoothed[k] if timed.jerk_limited else None
        mine = known.duration if known is not None else span.problem.compiled_duration
        before += mine
        for i, label in enumerate(labels):
            free = bound is not None and not bound[k, i]
            after[i] += mine if free else _duration_with(span, known, mine, label, factor, check)
        if len(span.problem.rests):
            span.problem.forget()
    ratios = after / before if before > 0.0 else np.ones(len(labels))
    durations = [timed.duration * float(ratio) for ratio in ratios]
    return [
        WhatIf(limit, joint, factor, duration, timed.duration - duration)
        for (limit, joint), duration in zip(labels, durations, strict=True)
    ]


def _bound_spans(timed: TimedPath, labels: Sequence[Label]) -> Flags | None:
    """Return which spans of a jerk-limited motion come near limits, shape (spans, labels).

    A span that stays clear of a limit is a local optimum under a wider one too. None: the motion
    has no jerk limits.
    """
    if not timed.jerk_limited or not timed.smoothed:
        return None
    mine, ratio, _ = _jerk_ratios(timed)
    counts = [len(each.motion.time) - 1 for each in timed.smoothed]
    begins = np.concatenate([[0], np.cumsum(counts)[:-1]])
    if sum(counts) != len(ratio):
        return None  # it stands somewhere for a while
    most = np.maximum.reduceat(ratio, begins, axis=0)
    return np.asarray(most[:, [mine.index(label) for label in labels]] > _CLEAR)


def _duration_with(
    span: SpanTiming,
    known: Smoothed | None,
    mine: float,
    label: Label,
    factor: float,
    check: Check,
) -> float:
    """Duration of a span with one limit changed [s]; ``mine`` without."""
    changed = _changed(span.problem, label, factor)
    try:
        if changed is span.problem:
            new = mine
        elif known is None:
            check()
            new = _changed_duration(span.problem, changed, label[1], factor)
        else:
            new = smooth_span_alike(changed, known, check).duration
    except EngineFailed as error:
        new = _unsolved(span, error, WhatIf(*label, factor, mine, 0.0))
    # The motion that is known keeps a wider limit as well.
    return new if factor < 1.0 else min(new, mine)


def _unsolved(span: SpanTiming, error: EngineFailed, change: WhatIf) -> float:
    """Return the duration that is known, where a limit is wider; or else fail."""
    if change.factor >= 1.0:
        return change.duration
    where = float(span.problem.grid.s[error.stage] / span.problem.path.length)
    raise TimingFailed(
        f"no path speed found at {where:.4f} of the path with {change.factor:g} times the "
        f"{change.limit} limit",
        position=where,
        joint=change.joint,
        limit=change.limit,
    ) from error


def _changed_duration(
    problem: SpanProblem, changed: SpanProblem, joint: str | None, factor: float
) -> float:
    """Duration of a problem with a limit changed; if wider, the rest of it is known."""
    if factor < 1.0 or changed.profile is problem.profile:
        return changed.compiled_duration
    return problem.duration_under(changed.profile, problem.profile.joint_names.index(str(joint)))


def _check_label(timed: TimedPath, label: Label) -> None:
    """Refuse a limit that a motion does not have."""
    labels: dict[Label, None] = {}
    for span in timed.spans:
        problem = span.problem
        labels |= dict.fromkeys(_joint_labels(problem.profile))
        if np.isfinite(problem.profile.jerk).any():
            labels |= dict.fromkeys(("jerk", name) for name in problem.profile.joint_names)
    for span in timed.spans:
        labels |= dict.fromkeys(x for c in span.problem.constraints for x in c.labels)
    if timed.spans and label not in labels:
        limit, joint = label
        raise InvalidRequest(
            f"this motion has no limit {limit!r} of joint {joint!r}",
            field="limit",
            allowed=[f"{k} {n}" if n else k for k, n in labels],
        )


def _changed(problem: SpanProblem, label: Label, factor: float) -> SpanProblem:
    """Return a problem with one limit multiplied; itself where it has no such limit."""
    limit, joint = label
    if limit in ("velocity", "acceleration", "jerk"):
        profile = problem.profile
        return problem.within(profile.scaled(limit, profile.joint_names.index(str(joint)), factor))
    if not any(label in constraint.labels for constraint in problem.constraints):
        return problem
    return problem.under(tuple(c.scaled(label, factor) for c in problem.constraints))
