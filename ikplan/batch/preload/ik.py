"""Kernels of single poses, loaded before workers are forked."""

from __future__ import annotations

import contextlib
import gc

from ikplan.pipeline.pose_batch.request import solve_ik_batch_request
from ikplan.pipeline.poses import solve_ik_request
from ikplan.pipeline.warm_up import warm_up

with contextlib.suppress(Exception):  # every pose tries again, and tells why
    warm_up(solve_ik_request, "ik")
    warm_up(solve_ik_batch_request, "ik-batch", "lm")
gc.freeze()  # what is shared stays shared
