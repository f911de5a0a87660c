"""One file of rows: resumed behind its last whole row, and never emptied while unfinished."""

from pathlib import Path

import pytest

from ikplan.batch.chunks import Line
from ikplan.batch.outcome import Outcome, failed, row_of
from ikplan.batch.output.row_file import RowFile, begin_row_file
from ikplan.errors import InvalidRequest

OUTCOMES = [Outcome(200, b'{"k": 0}'), failed(InvalidRequest("no")), Outcome(200, b'{"k": 2}')]
ROWS = [row_of(k, outcome) for k, outcome in enumerate(OUTCOMES)]
LINES = [Line(k, b"{}", 0) for k in range(3)]


@pytest.mark.parametrize("torn", [b"", ROWS[2][:1], ROWS[2][:-1]])
def test_whole_rows_are_kept_and_a_torn_one_is_written_again(torn: bytes, tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    file.write_bytes(ROWS[0] + ROWS[1] + torn)
    with pytest.raises(InvalidRequest, match="2 rows of a batch that may not be finished"):
        begin_row_file(file, lambda: 3)
    assert file.read_bytes() == ROWS[0] + ROWS[1] + torn
    output = RowFile(file, resume=True)
    assert output.rows == 2
    assert output.verdicts == {"invalid-request": 1}
    assert [line.index for line in output.remaining(LINES)] == [2]
    output.write(LINES[2], OUTCOMES[2])
    output.close()
    assert file.read_bytes() == b"".join(ROWS)


def test_a_finished_output_and_a_file_of_something_else_are_replaced(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    for content in (b"".join(ROWS), b"something else\n", b""):
        file.write_bytes(content)
        begin_row_file(file, lambda: 3).close()
        assert file.read_bytes() == b""


def test_a_file_that_is_no_output_is_not_resumed(tmp_path: Path) -> None:
    file = tmp_path / "rows.jsonl"
    for content in (b"something else\n", ROWS[1]):
        file.write_bytes(content)
        with pytest.raises(InvalidRequest, match="is not row 0 of a batch"):
            RowFile(file, resume=True)
        assert file.read_bytes() == content
