"""Imported by the process from which all workers are forked, so that workers start warm."""

from __future__ import annotations

import contextlib
import gc

from ikplan_api.workers import worker

with contextlib.suppress(Exception):  # every worker tries again and reports the failure
    worker.prepare()
gc.freeze()  # keeps the pages shared with the workers
