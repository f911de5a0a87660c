"""What a batch says of how far it is."""

import pytest

from ikplan.cli.terminal.batch_progress import BatchProgress, progress_text


def test_rate_time_left_and_verdicts() -> None:
    text = progress_text(12_400, {"unreachable": 3}, 36.1, 0.25, 1200.0)
    assert text == "12,400 lines, 25.0 %, 36.1 lines/s, 1:00:00 left, 3 unreachable"
    assert progress_text(7, {}, 2.0, 0.0, 3.5) == "7 lines, 2.0 lines/s"


def test_a_log_gets_a_line_a_minute_that_leaves_out_what_was_there_before(
    capsys: pytest.CaptureFixture[str],
) -> None:
    now = [0.0]
    progress = BatchProgress(1000, quiet=False, clock=lambda: now[0])
    progress.tell(51, {}, 500, 510)
    assert capsys.readouterr().err == ""
    now[0] = 100.0
    progress.tell(52, {"unreachable": 1}, 510, 600)
    progress.close()
    told = capsys.readouterr().err
    assert told == "ikplan: 52 lines, 20.0 %, 0.0 lines/s, 0:06:40 left, 1 unreachable\n"
    silent = BatchProgress(1000, quiet=True, clock=lambda: now[0] * 10.0)
    now[0] = 300.0
    silent.tell(1, {}, 0, 10)
    silent.close()
    assert capsys.readouterr().err == ""
