"""What to do about each type of problem, and the other statuses it comes with."""

from __future__ import annotations

from dataclasses import dataclass, field

from ikplan import errors

__all__ = ["WORDS", "Words"]


@dataclass(frozen=True, slots=True)
class Words:
    """Words on one type of problem, beside the docstring of its class.

    Attributes:
        what_to_do: Steps, the most useful one first.
        other_statuses: Cause of each HTTP status other than that of the class.
    """

    what_to_do: tuple[str, ...]
    other_statuses: dict[int, str] = field(default_factory=dict)


_REPAIRS = (
    "Apply one of `repairs`: each holds the fields to change, and a plan was found with them. With "
    "an empty list, no change that was tried helps."
)

WORDS: dict[type[errors.IkplanError], Words] = {
    errors.InvalidRequest: Words(
        (
            "Correct the fields in `errors`; `allowed` tells what the first one accepts.",
            "Compare the body with the schema in `/openapi.json`. The fields are checked before "
            "anything is planned: the same request fails again.",
        ),
        {
            403: "a robot of the catalogue cannot be deleted",
            404: "the service holds no scene of that id",
            406: "the format in `Accept` is not available",
            413: "the body is too long",
            415: "the `Content-Type` of the body is not accepted",
        },
    ),
    errors.RobotNotFound: Words(
        (
            "Take a name from `near` or `valid`. `GET /v1/robots` lists the same names.",
            "Upload the robot with `POST /v1/robots` if it is your own.",
        ),
    ),
    errors.PlanNotFound: Words(
        (
            "Check the id. The service keeps a bounded number of plans for a bounded time: an old "
            "plan is gone.",
            "Send the request again: the same request gives the same plan and the same id.",
        ),
    ),
    errors.InvalidRobot: Words(
        (
            "Correct the description at `joint` and `value`; `valid` lists the choices.",
            "Run `ikplan robots add FILE` on the description: it reports the same faults.",
        ),
    ),
    errors.Unreachable: Words(
        (
            _REPAIRS,
            "Read `reason`. Out of reach: move the part or the base of the robot. A joint in "
            "`limits`: turn the tool, or free its rotation about the axis of the tool.",
            "Raise the tolerance of the waypoint if `position_error` and `orientation_error` are "
            "acceptable.",
        ),
    ),
    errors.Disconnected: Words(
        (
            _REPAIRS,
            "Give another start, or none: a start in another posture may be able to follow the "
            "whole path.",
            "Put a `move` between the two `waypoints` where the tool may leave the path.",
        ),
    ),
    errors.InCollision: Words(
        (
            _REPAIRS,
            "Look at the robot at `q`: `pair` names the two bodies and `depth` says how much is "
            "missing.",
            "List the pair in `scene.allow` if its contact is meant, or lower `scene.clearance`.",
            "With `proven` false, a larger `budget_s` may find a way around.",
        ),
    ),
    errors.TimingFailed: Words(
        (
            _REPAIRS,
            "Raise the limit named by `limit` on `joint`, or drop the demand on duration or "
            "velocity that it contradicts.",
            "Look at the path near `position`: a sharp corner asks for a blend or a stop.",
        ),
    ),
    errors.BudgetExceeded: Words(
        (
            "Raise `budget_s`, up to the limit of the service.",
            "Make the request smaller: fewer waypoints, a simpler scene, a cheaper objective.",
            "`best` holds the joint values of the waypoints solved so far, if there are any.",
        ),
    ),
    errors.MemoryExceeded: Words(
        (
            "Make the request smaller: split a long path, sample at a lower rate, simplify the "
            "meshes of the scene.",
            "The operator of the service can raise its limit, `limit_bytes`.",
        ),
    ),
    errors.WorkerLost: Words(
        (
            "Send the request again: another process does the work.",
            "If it happens twice with one request, report the request and its id.",
        ),
    ),
    errors.CertificateViolated: Words(
        (
            "Do not run the motion; no plan was returned. This is a fault of ikplan, not of the "
            "request.",
            "Report the request and `violations`.",
        ),
    ),
    errors.AccessDenied: Words(
        (
            "Send the header `Authorization: Bearer <key>`. `ikplan keys new` makes a key, and the "
            "operator of the service adds it.",
        ),
        {
            403: "the service has no keys and the connection is not a loopback one, or the host or "
            "the page that asks is not accepted",
        },
    ),
    errors.RateLimited: Words(
        (
            "Wait for `retry_after_s`, also in the header `Retry-After`, and ask again.",
            "Put many requests into one batch: one `POST /v1/batches` counts once.",
        ),
    ),
    errors.ServiceUnavailable: Words(
        (
            "Wait for `retry_after_s`, if it is given, and ask again: the queue is full, or the "
            "service starts or stops.",
            "Ask `/readyz` whether the service takes requests.",
            "In the client, this error also means that the address cannot be reached, or that the "
            "answer is not from this service: check `url` and `status_code`.",
        ),
    ),
}
"""Words on every type of problem that the service may answer."""
