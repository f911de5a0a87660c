"""What is carried, counted by the order in which segments are passed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from ikplan.errors import CertificateViolated
from ikplan.scene.body import Body, CollisionModel

__all__ = ["counted_in_order"]


def counted_in_order(model: CollisionModel, order: Sequence[int]) -> CollisionModel:
    """Return a model whose bodies count segments by their place in an order.

    Args:
        model: The bodies, which count segments by their number.
        order: Numbers of the segments in the order passed.

    Raises:
        CertificateViolated: The segments over which a body is carried are passed apart from each
            other, or in another order than that of their numbers.
    """
    place = {number: k for k, number in enumerate(order)}
    return replace(model, bodies=tuple(_counted(body, place) for body in model.bodies))


def _counted(body: Body, place: dict[int, int]) -> Body:
    if body.first_segment is None and body.last_segment is None:
        return body
    first = 0 if body.first_segment is None else body.first_segment
    last = len(place) - 1 if body.last_segment is None else body.last_segment
    places = [place[k] for k in range(first, last + 1) if k in place]
    if not places:
        return body
    together = places == list(range(places[0], places[-1] + 1))
    starts = body.first_segment is not None or places[0] == 0
    stays = body.last_segment is not None or places[-1] == len(place) - 1
    if not (together and starts and stays):
        raise CertificateViolated(
            f"{body.name!r} is carried over segments {first} to {last}, which are passed at "
            f"{places}",
            certificate={},
            violations=[f"{body.name!r} is carried over segments that are passed apart"],
        )
    return replace(body, first_segment=places[0], last_segment=places[-1])
