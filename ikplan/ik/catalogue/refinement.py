"""Solvers that follow the Jacobian, and the closed form."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import LI, choice, number
from ikplan.ik.solver import Solver, common_parameters

__all__ = ["REFINEMENT"]

_LM = Solver(
    name="lm",
    title="Levenberg-Marquardt on SE(3) with joint limits and restarts",
    source="Sugihara, Solvability-Unconcerned Inverse Kinematics by the Levenberg-Marquardt "
    "Method, IEEE Transactions on Robotics 2011, 27(5); restarts by Roberts' R_d sequence",
    family="refinement",
    notes="The fastest: returns the first solution found, from the start configuration outwards.",
    population=None,
    iterations=40,
    evaluations="about 15 where the start leads to the target",
    module="ikplan.ik.restarts",
    kernel="solve_lm",
    parameters=[
        number(
            "restarts",
            2000,
            "Further seeds, evenly spread over the limits, before giving up.",
            maximum=100_000,
        ),
    ],
)

_NEWTON = Solver(
    name="newton-raphson",
    title="Newton-Raphson on the pose error",
    source=f"{LI}, Table 5; the step and the treatment of joint limits are ours",
    family="newton",
    notes="Starts at q = 0, or warm at the start configuration. As in the paper it knows no joint "
    "limits: raw results can lie outside them.",
    population=None,
    iterations=100,
    evaluations="1 + 2 a step: forward kinematics and Jacobians",
    module="ikplan.ik.newton_raphson",
    kernel="newton_raphson",
    params_type="NewtonParams",
    parameters=[
        choice("limits", ["wrap", "clip"], "Wrap angles to (-pi, pi], or clip to the limits."),
        number("damping", 0.0, "Added to the diagonal of J J^T; 0: pseudoinverse.", unit="mm^2"),
        number("restarts", 0, "Further starts within the limits.", maximum=100_000),
        number("length", 0.1, "What one radian of rotation error weighs.", unit="m"),
        number("rcond", 1e-10, "Relative size of singular values that count as zero."),
        number("tolerance", 1e-10, "A start is done at an error this small.", unit="mm"),
        *(p for p in common_parameters() if p.name != "bounds"),
    ],
)

_CLOSED_FORM = Solver(
    name="closed-form",
    title="All branches in closed form, and of them the nearest",
    source="Elias, Wen, IK-Geo: Unified robot inverse kinematics using subproblem decomposition, "
    "Mechanism and Machine Theory 2025, 209, sections 3 and 4",
    family="closed-form",
    notes="For arms of six joints whose last three axes meet in one point, or whose axes 2, 3 and "
    "4 are parallel and the last two meet; which, is found from the chain. A singular pose, a "
    "position, and a target with a freedom are solved as by lm.",
    population=None,
    iterations=40,
    evaluations="1, for the check of the nearest branch",
    module="ikplan.ik.closed_form",
    kernel="solve_closed_form_pose",
    parameters=[
        number(
            "restarts",
            200,
            "Further seeds of a target that the closed form does not solve, before giving up.",
            maximum=100_000,
        ),
    ],
)

REFINEMENT = [_LM, _NEWTON, _CLOSED_FORM]
