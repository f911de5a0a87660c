"""The exit code of each error: 1 no plan, 2 wrong input, 3 the service or a fault of ikplan."""

from __future__ import annotations

import json

import pytest

from ikplan import CertificateViolated, IkplanError, InvalidInput, NoPlan, ServiceError
from ikplan.cli.terminal.failing import fail
from tests.documents.test_errors import EXAMPLES

CODES = {NoPlan: 1, InvalidInput: 2, ServiceError: 3, CertificateViolated: 3}


@pytest.mark.parametrize("error", EXAMPLES, ids=lambda e: type(e).__name__)
def test_the_group_of_an_error_decides_its_exit_code(
    error: IkplanError, capsys: pytest.CaptureFixture[str]
) -> None:
    (code,) = (code for group, code in CODES.items() if isinstance(error, group))
    assert fail(error, as_json=True) == code
    printed = capsys.readouterr()
    assert json.loads(printed.out)["type"] == error.problem_type()
    assert error.detail in printed.err
