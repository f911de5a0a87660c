"""What holds for every test: no service of a test writes into the user's folders."""

import gc
import os
import warnings

os.environ["IKPLAN_STORE_PATH"] = ":memory:"


def pytest_unconfigure() -> None:
    """Free the ends of local sockets that outlive the last test of a whole run.

    They are two, of a worker's socket pairs; no file of tests leaves them by itself. Anything else
    that is left open ends the run as an error.
    """
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"unclosed <socket\.socket fd=\d+, family=1,")
        gc.collect()
