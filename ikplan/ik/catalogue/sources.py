"""The papers that the entries cite, and a shorthand for entries."""

from __future__ import annotations

from ikplan.ik.solver import Parameter

__all__ = ["KANAGARAJ", "LI", "SLIM", "choice", "fraction", "number"]

SLIM = (
    "Slim, Rokbani, Neji, Terres, Beyrouthy, Inverse Kinematic Solver Based on Bat Algorithm for "
    "Robotic Arm Path Planning, Robotics 2023, 12, 38"
)
KANAGARAJ = (
    "Kanagaraj, Sheik Masthan, Yu, Meta-Heuristics Based Inverse Kinematics of Robot Manipulator's "
    "Path Tracking Capability Under Joint Limits, MENDEL 2022, 28(1), 41-54"
)
LI = (
    "Li, Luo, Qiao, Inverse Kinematics of Robot Manipulator Based on BODE-CS Algorithm, Machines "
    "2023, 11(6), 648"
)


def number(
    name: str,
    default: float,
    description: str,
    *,
    minimum: float | None = 0.0,
    maximum: float | None = None,
    unit: str | None = None,
) -> Parameter:
    """Return a number: not negative, unless said otherwise; whole where its default is an int."""
    return Parameter(
        name=name,
        default=default,
        description=description,
        minimum=minimum,
        maximum=maximum,
        unit=unit,
    )


def fraction(name: str, default: float, description: str) -> Parameter:
    """Return a number in 0..1."""
    return number(name, default, description, maximum=1.0)


def choice(name: str, choices: list[str], description: str) -> Parameter:
    """Return a choice; the first is the default."""
    return Parameter(name=name, default=choices[0], choices=choices, description=description)
