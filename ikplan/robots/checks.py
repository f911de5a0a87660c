"""Checks of numeric arguments, each naming the field."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ikplan.errors import InvalidRequest

__all__ = ["finite_vector", "positive_vector", "unit_quaternion"]

_QUATERNION_TOLERANCE = 1e-3


def finite_vector(
    values: ArrayLike, length: int, field: str, names: Sequence[str] = ()
) -> NDArray[np.float64]:
    """Return ``values`` as an array of ``length`` finite numbers.

    Args:
        values: Array-like of shape (length,).
        length: The length wanted.
        field: Name of the field, for messages.
        names: What the entries are called, for messages.

    Raises:
        InvalidRequest: Not numbers, of another shape, or not finite.
    """
    try:
        array = np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise InvalidRequest(
            f"{field}: not a list of {length} numbers",
            field=field,
            allowed=f"{length} finite numbers",
        ) from error
    if array.shape != (length,):
        got = f"{array.size} values" if array.ndim == 1 else f"an array of shape {array.shape}"
        of = f" ({', '.join(names)})" if names else ""
        raise InvalidRequest(
            f"{field}: {length} values expected{of}, got {got}",
            field=field,
            allowed=f"{length} finite numbers",
        )
    if not np.isfinite(array).all():
        i = int(np.flatnonzero(~np.isfinite(array))[0])
        raise InvalidRequest(
            f"{field}[{i}]: {array[i]} is not a finite number; it must be {length} of them",
            field=field,
            allowed=f"{length} finite numbers",
        )
    return array


def positive_vector(
    values: ArrayLike, length: int, field: str, names: Sequence[str] = ()
) -> NDArray[np.float64]:
    """Return ``values``, one number or ``length`` of them, as that many positive numbers.

    Raises:
        InvalidRequest: As :func:`finite_vector`, or a number is not positive.
    """
    if np.ndim(values) == 0:
        values = np.full(length, values)
    array = finite_vector(values, length, field, names)
    if not (array > 0).all():
        i = int(np.flatnonzero(~(array > 0))[0])
        raise InvalidRequest(
            f"{field}[{i}]: {array[i]} is not positive", field=field, allowed="> 0"
        )
    return array


def unit_quaternion(values: ArrayLike, field: str) -> tuple[float, float, float, float]:
    """Return a quaternion of unit length; of ``q`` and ``-q`` always the same one.

    Args:
        values: Quaternion xyzw, of unit length within 1e-3.
        field: Name of the field, for messages.

    Raises:
        InvalidRequest: As :func:`finite_vector`, or the length is further from one.
    """
    array = finite_vector(values, 4, field)
    norm = float(np.sqrt(array @ array))
    if abs(norm - 1.0) > _QUATERNION_TOLERANCE:
        raise InvalidRequest(
            f"{field}: the length is {norm:.6g}; it must be a unit quaternion (normalised here "
            f"within {_QUATERNION_TOLERANCE:g})",
            field=field,
            allowed="a unit quaternion (x, y, z, w)",
        )
    leading = next(v for v in array[::-1] if v != 0.0)
    x, y, z, w = (float(v) / (norm if leading > 0 else -norm) + 0.0 for v in array)
    return (x, y, z, w)
