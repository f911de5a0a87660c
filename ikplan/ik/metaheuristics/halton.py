"""The Halton sequence: evenly spread points, one prime base a dimension."""

from __future__ import annotations

from ikplan._jit import kernel
from ikplan.arrays import Array

__all__ = ["halton_into"]


@kernel
def _next_prime(after: int) -> int:
    """Return the smallest prime above ``after``."""
    candidate = after
    while True:
        candidate += 1
        divisor, prime = 2, candidate > 1
        while prime and divisor * divisor <= candidate:
            prime = candidate % divisor != 0
            divisor += 1
        if prime:
            return candidate


@kernel
def halton_into(X: Array) -> None:
    """Write Halton points 1..N of the unit cube, shape (N, D), with the first D primes as bases."""
    base = 1
    for k in range(X.shape[1]):
        base = _next_prime(base)
        for n in range(X.shape[0]):
            index, digit, value = n + 1, 1.0 / base, 0.0
            while index > 0:
                value += (index % base) * digit
                index //= base
                digit /= base
            X[n, k] = value
