"""Kernels of timings, loaded before workers are forked."""

from __future__ import annotations

import contextlib
import gc

from ikplan.pipeline.retime import time_request
from ikplan.pipeline.warm_up import warm_up

with contextlib.suppress(Exception):  # every timing tries again, and tells why
    warm_up(time_request, "time", jerk=True)
gc.freeze()  # what is shared stays shared
