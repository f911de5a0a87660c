"""``ikplan plans``: what a service keeps."""

from __future__ import annotations

import argparse
import itertools
import os

from ikplan.cli.terminal.output import say, say_json, table
from ikplan.errors import InvalidRequest

__all__ = ["plans", "server_of"]

_SERVER = "http://127.0.0.1:8000"


def server_of(options: argparse.Namespace) -> str:
    """Return the address of the service that is meant."""
    return options.server or os.environ.get("IKPLAN_SERVER") or _SERVER


def plans(options: argparse.Namespace) -> None:
    """List the plans and jobs of a service.

    Raises:
        InvalidRequest: An option makes no sense.
        ServiceUnavailable: The service cannot be reached.
    """
    if options.limit < 1:
        raise InvalidRequest("--limit: at least 1", field="--limit", allowed="1 or more")
    from ikplan.client import Client

    with Client(server_of(options)) as client:
        found = client.plans(
            robot=options.robot,
            outcome=options.outcome,
            since=options.since,
            until=options.until,
        )
        listed = list(itertools.islice(found, options.limit))
    if options.json:
        say_json({"plans": [plan.model_dump(mode="json") for plan in listed]})
        return
    rows = [
        (
            plan.id,
            plan.time,
            plan.robot or "-",
            plan.problem or plan.outcome,
            str(plan.bytes or "-"),
        )
        for plan in listed
    ]
    say(*table(("id", "time", "robot", "outcome", "bytes"), rows, left=4))
