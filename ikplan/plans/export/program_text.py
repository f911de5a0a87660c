"""What programs of points share: who can have one, and the thinned plan in the maker's terms."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ikplan.arrays import Array
from ikplan.errors import InvalidRequest, RobotNotFound
from ikplan.plans.export.formats import Arm
from ikplan.plans.programs.times import ANY_TIMES, Times

if TYPE_CHECKING:
    from ikplan.documents.controller import LanguageInfo
    from ikplan.documents.plan_document import PlanDocument
    from ikplan.plans.programs.certificate import ProgramCertificate, ProgramInterpolation
    from ikplan.robots import Robot

__all__ = [
    "PointProgram",
    "comments",
    "fixed",
    "known_robot",
    "language_of",
    "name_from",
    "points_of",
    "refusal",
    "refuse_longer",
    "single_precision",
]

_SIX = (6,)
_WORDS = {5: "five", 6: "six", 7: "seven"}


@dataclass(frozen=True)
class PointProgram:
    """A thinned plan as a program counts it.

    Attributes:
        degrees: Joint values in degrees, as the maker counts joints, shape (n, dof).
        steps: Time from each point to the next, whole ticks, shape (n - 1,) [s].
        tool: Positions of the tool at the points, shape (n, 3) [m].
        turned: Rotation of the tool from each point to the next, shape (n - 1,) [rad].
        certificate: What holds of the motion.
    """

    degrees: Array
    steps: Array
    tool: Array
    turned: Array
    certificate: ProgramCertificate


def language_of(
    arm: Arm,
    name: str,
    title: str,
    joints: tuple[int, ...] = _SIX,
    built_in: Mapping[str, LanguageInfo] | None = None,
) -> LanguageInfo:
    """Return what is known of a language of an arm's controller.

    Args:
        arm: The arm.
        name: Name of the language.
        title: The same, for people.
        joints: How many turning joints an arm may have.
        built_in: Arms of the catalogue that run the language although the ``controller`` block that
            their plans carry does not say so.

    Raises:
        InvalidRequest: Its controller is not known, runs other programs, or the arm has other
            joints.
    """
    controller = arm.controller
    found = controller.language(name) if controller is not None else None
    if found is None and built_in is not None:
        found = built_in.get(arm.robot)
    if found is None:
        why = "its controller runs none" if controller is not None else "no controller is known"
        raise refusal(
            name,
            f"no {title} program for {arm.robot!r}: {why}; a robot whose controller has the "
            f'language "{name}" can have one',
        )
    if arm.units not in [("rad",) * count for count in joints]:
        words = " or ".join(_WORDS[count] for count in joints)
        raise refusal(
            name,
            f"no {title} program for {arm.robot!r}: it moves {words} turning joints, and this "
            f"chain has {len(arm.units)} joints ({', '.join(arm.units)})",
        )
    return found


def points_of(
    plan: PlanDocument,
    language: LanguageInfo,
    kind: ProgramInterpolation,
    stored: Callable[[Array], Array],
    robot: Robot | None = None,
    tolerance: float | None = None,
    times: Times = ANY_TIMES,
) -> PointProgram:
    """Thin a plan and count its points as programs do.

    Args:
        plan: The plan.
        language: The language.
        kind: What the controller does between points.
        stored: From degrees to those that are left of them in the program's text.
        robot: The robot with its tool; None: that of the catalogue.
        tolerance: Largest distance from the path [m]; None: 0.1 mm.
        times: What the steps may take.

    Raises:
        InvalidRequest: The robot is not in the catalogue, or no points keep the tolerance.
    """
    from ikplan.plans.programs.thinning import TOLERANCE, thin

    known = known_robot(plan, language.name, robot)
    matrix = np.eye(known.dof) if language.joints is None else np.array(language.joints)
    back = np.linalg.inv(matrix)

    def kept(q: Array) -> Array:
        return np.asarray(np.radians(stored(np.degrees(q @ matrix.T))) @ back.T)

    asked = TOLERANCE if tolerance is None else tolerance
    program = thin(plan, known, kind, tolerance=asked, stored=kept, times=times)
    R, p = known.poses(program.q)
    cosine = (np.einsum("mij,mij->m", R[:-1], R[1:]) - 1.0) / 2.0
    return PointProgram(
        degrees=stored(np.degrees(program.q @ matrix.T)) + 0.0,
        steps=np.round(np.diff(program.time), 6),
        tool=p,
        turned=np.arccos(np.clip(cosine, -1.0, 1.0)),
        certificate=program.certificate,
    )


def comments(plan: PlanDocument, certificate: ProgramCertificate) -> list[str]:
    """Return what a program says of itself, in lines of ASCII."""
    c = certificate
    between = {
        "blended": "moves linear in the joints, corners parabolas over half of the shorter step",
        "spline": "cubic splines of the joints through the points, at rest at both ends",
        "waypoints": "Ruckig's moves from waypoint to waypoint, one sample each 1 ms",
    }[c.interpolation]
    return [
        f"plan {plan.id} for {plan.robot}",
        f"{c.points} points, {fixed(c.duration)} s, {c.time_factor:.4f} times the plan's time",
        f"if the controller makes {between}:",
        f"tool within {1e3 * c.max_path_deviation:.4f} mm and "
        f"{np.degrees(c.max_orientation_deviation):.4f} deg of the plan's path,",
        f"at most {c.velocity_limit_ratio:.4f} of the joint speed limits and "
        f"{c.acceleration_limit_ratio:.4f} of the acceleration limits",
    ]


def fixed(value: float, digits: int = 6) -> str:
    """Return a number in decimals without trailing zeros, and without a sign at zero."""
    return f"{value + 0.0:.{digits}f}".rstrip("0").rstrip(".")


def name_from(stem: str, longest: int) -> str:
    """Return a name for a program from that of a file: letters, digits, underscores."""
    name = re.sub(r"[^A-Za-z0-9_]", "_", stem) or "ikplan"
    return (name if name[0].isalpha() else f"p_{name}")[:longest]


def single_precision(degrees: Array, digits: int) -> Array:
    """Return degrees with some decimals, as a controller holds them in single precision."""
    return np.asarray(np.round(degrees, digits).astype(np.float32).astype(np.float64))


def refuse_longer(language: LanguageInfo, robot: str, points: int, why: str = "") -> None:
    """Refuse a program of more points than the longest that the controller is known to run.

    Args:
        language: What is known of the language.
        robot: Name of the robot.
        points: How many the program has.
        why: Why it is not split, to be told.

    Raises:
        InvalidRequest: It has more.
    """
    longest = language.longest_program
    if longest is not None and points > longest:
        raise refusal(
            language.name,
            f"the program would have {points} points, and the longest that the controller of "
            f"{robot!r} is known to run has {longest}{why}: plan the path in parts, each from "
            "where the one before ends, or give the robot's controller another longest_program",
        )


def refusal(language: str, detail: str) -> InvalidRequest:
    """Return the error that refuses a format."""
    return InvalidRequest(detail, field="format", allowed=f"another format than {language}")


def known_robot(plan: PlanDocument, language: str, robot: Robot | None) -> Robot:
    """Return the robot of a plan: the one given, else that of the catalogue.

    Raises:
        InvalidRequest: The catalogue does not have it.
    """
    if robot is not None:
        return robot
    from ikplan.robots import catalogue_robot

    try:
        return catalogue_robot(plan.robot)
    except RobotNotFound as error:
        raise refusal(
            language,
            f"{plan.robot!r} is not in the catalogue, and thinning a plan needs its robot: give "
            "it to encode or save",
        ) from error
