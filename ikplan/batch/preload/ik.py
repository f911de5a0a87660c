"""Kernels of single poses, loaded before workers are forked."""

from __future__ import annotations

import contextlib
import gc

from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.warm_up import warm_up

with contextlib.suppress(Exception):  # every pose tries again, and tells why
    warm_up(solve_ik_request, "ik")
gc.freeze()  # what is shared stays shared
