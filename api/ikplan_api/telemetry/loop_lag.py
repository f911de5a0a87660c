"""How late the event loop is: what every client waits for that asks for anything."""

from __future__ import annotations

import asyncio

from ikplan_api.telemetry.metrics import Metrics

__all__ = ["watch_loop"]

_EVERY_S = 0.1


async def watch_loop(metrics: Metrics) -> None:
    """Record for how long the event loop keeps a ready task waiting, until cancelled."""
    loop = asyncio.get_running_loop()
    while True:
        due = loop.time() + _EVERY_S
        await asyncio.sleep(_EVERY_S)
        metrics.loop_lag.observe(max(0.0, loop.time() - due))
