"""The entries of the solver registry, with the papers' parameters."""

from __future__ import annotations

from ikplan.ik.registry import COMMON, Parameter, Solver

__all__ = ["CATALOGUE"]

_SLIM = (
    "Slim, Rokbani, Neji, Terres, Beyrouthy, Inverse Kinematic Solver Based on Bat Algorithm for "
    "Robotic Arm Path Planning, Robotics 2023, 12, 38"
)

IK_BA = Solver(
    name="ik-ba",
    title="Bat algorithm for inverse kinematics (IK-BA)",
    source=f"{_SLIM}, section 4.2, Algorithm 2, Table 1",
    family="metaheuristic",
    notes="The paper's constant behind the noise of Eq. 14 is not stated: eps_scale 1 is the literal "
    "reading, 0.15 is calibrated by us to the published errors.",
    population=50,
    iterations=200,
    planner_population=12,
    planner_iterations=25,
    evaluations="N + N T (variant local), N + 2 N T (both)",
    module="ikplan.ik.metaheuristics.ik_ba",
    kernel="ik_ba",
    params_type="IkBaParams",
    parameters=[
        Parameter(name="fmin", default=0.0, description="Smallest frequency, Eq. 5."),
        Parameter(name="fmax", default=2.0, description="Largest frequency, Eq. 5."),
        Parameter(
            name="alpha",
            default=0.97,
            minimum=0.0,
            maximum=1.0,
            description="Loudness factor, Eq. 9.",
        ),
        Parameter(
            name="gamma", default=0.1, minimum=0.0, description="Rise of the pulse rate, Eq. 10."
        ),
        Parameter(name="A0", default=1.0, minimum=0.0, description="Initial loudness."),
        Parameter(
            name="r0", default=1.0, minimum=0.0, maximum=1.0, description="Limit of the rate."
        ),
        Parameter(
            name="eps_scale",
            default=1.0,
            minimum=0.0,
            unit="rad or m",
            description="Factor of the noise of Eq. 14: 1 literal, 0.15 calibrated.",
        ),
        Parameter(
            name="noise",
            default="uniform",
            choices=["uniform", "normal"],
            description="Distribution of eps in Eq. 14: uniform in [-1, 1), or standard normal.",
        ),
        Parameter(
            name="variant",
            default="local",
            choices=["local", "both", "both_attract"],
            description="Which candidates are evaluated: Eq. 14 only; Eqs. 7 and 13 as well; the "
            "same with the sign of Eq. 13 turned.",
        ),
        Parameter(
            name="accept",
            default="greedy",
            choices=["greedy", "loudness"],
            description="Keep every better candidate, or only with the probability of the loudness.",
        ),
        *COMMON,
    ],
)

LM = Solver(
    name="lm",
    title="Levenberg-Marquardt on SE(3) with joint limits and restarts",
    source="Sugihara, Solvability-Unconcerned Inverse Kinematics by the Levenberg-Marquardt Method, "
    "IEEE Transactions on Robotics 2011, 27(5); restarts by Roberts' R_d sequence",
    family="refinement",
    notes="The fastest: returns the first solution found, from the start configuration outwards.",
    population=None,
    iterations=40,
    evaluations="about 15 where the start leads to the target",
    module="ikplan.ik.lm",
    kernel="solve_lm",
    parameters=[
        Parameter(
            name="restarts",
            default=500,
            minimum=0,
            maximum=100_000,
            description="Further seeds, evenly spread over the limits, before giving up.",
        ),
    ],
)

CATALOGUE = [IK_BA, LM]
