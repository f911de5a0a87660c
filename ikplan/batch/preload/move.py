"""Kernels of moves, loaded before workers are forked."""

from __future__ import annotations

import contextlib
import gc

from ikplan.pipeline.plan import plan
from ikplan.pipeline.warm_up import warm_up

with contextlib.suppress(Exception):  # every move tries again, and tells why
    warm_up(plan, "plan", moves=True)
gc.freeze()  # what is shared stays shared
