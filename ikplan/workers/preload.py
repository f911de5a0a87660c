"""Imported once by the process that those of a batch are forked from: they are born warm."""

from __future__ import annotations

import contextlib
import gc

from ikplan.pipeline.timing_stage import warm_up_timing
from ikplan.pipeline.warm_up import warm_up

with contextlib.suppress(Exception):  # every plan tries again, and tells why
    warm_up()
    warm_up_timing(jerk=False)
gc.freeze()  # what is shared stays shared
