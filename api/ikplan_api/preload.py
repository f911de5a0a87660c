"""Imported once by the process that all workers are forked from: they are born warm."""

from __future__ import annotations

import contextlib
import gc

from ikplan_api import worker

with contextlib.suppress(Exception):  # every worker tries again, and tells why
    worker.prepare()
gc.freeze()  # what is shared stays shared
