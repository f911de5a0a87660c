"""Documents written and read fast are those that the slow ways write and read."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays
from numpy.typing import NDArray

from ikplan.documents import load_json, write_json
from ikplan.documents.pose_results import FkResult
from ikplan.documents.trajectory import Trajectory

finite = st.floats(allow_nan=False, allow_infinity=False)


@given(arrays(np.float64, array_shapes(min_dims=2, max_dims=2), elements=finite))
def test_arrays_are_written_byte_for_byte_as_pydantic_writes_them(
    values: NDArray[np.float64],
) -> None:
    document = Trajectory(time=values[:, 0], q=values, dq=values[::2], ddq=values.T)
    assert write_json(document) == document.model_dump_json().encode()


@pytest.mark.parametrize("shape", [(0,), (0, 0)])
def test_empty_arrays_are_written_too(shape: tuple[int, ...]) -> None:
    empty = np.zeros(shape)
    document = Trajectory(time=[], q=empty, dq=empty, ddq=empty)
    assert write_json(document) == document.model_dump_json().encode()


@given(st.lists(finite, min_size=3, max_size=3))
def test_what_was_written_is_read_back_to_the_last_bit(position: list[float]) -> None:
    written = write_json(FkResult(position=position, quaternion_xyzw=[0, 0, 0, 1]))
    read = FkResult.model_validate_json(written)
    assert read.position.tobytes() == np.array(position, dtype=np.float64).tobytes()


values = st.recursive(
    st.none() | st.booleans() | st.integers() | finite | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(values)
def test_json_is_read_as_python_reads_it(value: Any) -> None:
    text = json.dumps(value)
    for document in (text, text.encode()):
        read = load_json(document)
        assert repr(read) == repr(json.loads(text))
