"""What holds for every test: no service of a test writes into the user's folders."""

import gc
import os
import warnings

os.environ["IKPLAN_STORE_PATH"] = ":memory:"


def pytest_unconfigure() -> None:
    """Free the sockets that services of the whole session began their workers with.

    They go with the last objects that hold them, after the last test: no test has left them.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ResourceWarning)
        gc.collect()
