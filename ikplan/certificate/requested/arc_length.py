"""The arc length of a curve, by quadrature, and its inverse."""

from __future__ import annotations

import numpy as np

from ikplan.arrays import Array
from ikplan.certificate.requested.curves import Curve

__all__ = ["ArcLength"]


_X, _W = np.polynomial.legendre.leggauss(8)
_X, _W = 0.5 * (_X + 1.0), 0.5 * _W
"""Gauss points and weights on [0, 1]."""
_EXACT = 1e-10
"""Error allowed in the length between two nodes, as a share of it."""
_POINT = 1e-12
"""A part that is no longer than this share of the whole is not halved."""
_LEVELS = 40


class ArcLength:
    """Arc length s(t) of a curve, and t(s).

    The speed |dp/dt| is integrated by Gauss-Legendre quadrature between nodes, which are halved
    until both halves together give what the whole gives, so that they are dense where the curve
    bends sharply.

    Attributes:
        curve: The curve.
        t: Parameters of the nodes, shape (k + 1,).
        s: Arc length at the nodes, shape (k + 1,) [m].
        length: The whole length [m].
    """

    def __init__(self, curve: Curve) -> None:
        self.curve = curve
        a, b = np.array(curve.breaks[:-1]), np.array(curve.breaks[1:])
        lengths = self._between(a, b)
        point = _POINT * float(lengths.sum())
        done: list[tuple[Array, Array]] = []
        for _ in range(_LEVELS):
            middle = 0.5 * (a + b)
            first, second = self._between(a, middle), self._between(middle, b)
            halves = first + second
            fits = (np.abs(halves - lengths) <= _EXACT * halves) | (halves <= point)
            done.append((a[fits], halves[fits]))
            a, middle, b = a[~fits], middle[~fits], b[~fits]
            if len(a) == 0:
                break
            lengths = np.concatenate([first[~fits], second[~fits]])
            a, b = np.concatenate([a, middle]), np.concatenate([middle, b])
        else:
            done.append((a, lengths))
        begins, parts = (np.concatenate(column) for column in zip(*done, strict=True))
        order = np.argsort(begins)
        self.t: Array = np.append(begins[order], curve.breaks[-1])
        self.s: Array = np.concatenate([[0.0], np.cumsum(parts[order])])
        self.length = float(self.s[-1])

    def _speed(self, t: Array) -> Array:
        _, first, _ = self.curve.derivatives(t)
        return np.asarray(np.sqrt((first * first).sum(axis=1)))

    def _between(self, a: Array, b: Array) -> Array:
        """Arc lengths from parameters a to b, each of shape (m,) [m]."""
        t = a[:, None] + (b - a)[:, None] * _X
        return np.asarray(self._speed(t.ravel()).reshape(t.shape) @ _W * (b - a))

    def at(self, t: Array) -> Array:
        """Return the arc length at parameters t, shape (m,) [m]."""
        k = np.clip(np.searchsorted(self.t, t, "right") - 1, 0, len(self.t) - 2)
        return np.asarray(self.s[k] + self._between(self.t[k], t))

    def parameter(self, s: Array) -> Array:
        """Return the parameters at arc lengths s, shape (m,), by Newton's method in a bracket."""
        k = np.clip(np.searchsorted(self.s, s, "right") - 1, 0, len(self.s) - 2)
        low, high = self.t[k], self.t[k + 1]
        part = self.s[k + 1] - self.s[k]
        share = (s - self.s[k]) / np.where(part > 0.0, part, 1.0)
        t = low + (high - low) * np.clip(share, 0.0, 1.0)
        target, begin = s - self.s[k], low.copy()
        active = np.arange(len(t))
        for _ in range(60):
            now = t[active]
            miss = self._between(begin[active], now) - target[active]
            above = miss > 0.0
            high[active[above]] = now[above]
            low[active[~above]] = now[~above]
            speed = self._speed(now)
            step = now - miss / np.where(speed > 0.0, speed, 1.0)
            inside = (step >= low[active]) & (step <= high[active]) & (speed > 0.0)
            found = np.abs(miss) <= 1e-13 * (1.0 + self.length)
            # Where the curve turns back within a point, its speed is 0, and no step leads on.
            other = np.where(found, now, 0.5 * (low[active] + high[active]))
            t[active] = np.where(inside, step, other)
            active = active[~found]
            if len(active) == 0:
                break
        return t
