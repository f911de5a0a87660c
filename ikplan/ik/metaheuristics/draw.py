"""Random draws that several searches share."""

from __future__ import annotations

import math

import numpy as np

from ikplan._jit import kernel
from ikplan.arrays import Indices

__all__ = ["distinct", "levy_deviation", "levy_step", "permutation", "signed", "subset"]


@kernel
def signed(rng: np.random.Generator) -> float:
    """Draw uniformly from [-1, 1)."""
    return 2.0 * rng.random() - 1.0


@kernel
def distinct(n: int, exclude: int, out: Indices, rng: np.random.Generator) -> None:
    """Draw distinct indices below n, none of them ``exclude`` (-1: none is excluded).

    Args:
        n: Number of individuals, larger than the number of indices wanted.
        exclude: Index not to be drawn, or -1.
        out: Out: the indices, shape (m,).
        rng: Random numbers; one is drawn for each index, and again after each double.
    """
    for m in range(out.shape[0]):
        again = True
        while again:
            out[m] = int(rng.random() * n)
            again = out[m] == exclude
            for other in range(m):
                again = again or out[m] == out[other]


@kernel
def permutation(n: int, out: Indices, rng: np.random.Generator) -> None:
    """Write a random order of 0..n - 1 (Fisher and Yates), shape (n,)."""
    subset(n, n, out, rng)


@kernel
def subset(n: int, m: int, out: Indices, rng: np.random.Generator) -> None:
    """Write a random order of 0..n - 1 of which the first m are drawn, shape (n,)."""
    for i in range(n):
        out[i] = i
    for i in range(m):
        j = i + int(rng.random() * (n - i))
        out[i], out[j] = out[j], out[i]


@kernel
def levy_deviation(beta: float) -> float:
    """Return sigma_u of Mantegna's Levy step, a standard deviation; 0.696575 for beta = 3/2."""
    over = math.gamma(1.0 + beta) * math.sin(0.5 * math.pi * beta)
    under = math.gamma(0.5 * (1.0 + beta)) * beta * 2.0 ** (0.5 * (beta - 1.0))
    return float((over / under) ** (1.0 / beta))


@kernel
def levy_step(sigma_u: float, beta: float, rng: np.random.Generator) -> float:
    """Draw a Levy step u / |v|^(1/beta), u of deviation sigma_u, v standard normal."""
    u = sigma_u * rng.standard_normal()
    v = abs(rng.standard_normal())
    return float(u / v ** (1.0 / beta))
