"""The bat algorithms."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import KANAGARAJ, SLIM, choice, fraction, number
from ikplan.ik.solver import Parameter, Solver, common_parameters

__all__ = ["BATS"]

_IK_BA = Solver(
    name="ik-ba",
    title="Bat algorithm for inverse kinematics (IK-BA)",
    source=f"{SLIM}, section 4.2, Algorithm 2, Table 1",
    family="metaheuristic",
    notes="The paper's constant behind the noise of Eq. 14 is not stated: eps_scale 1 is the "
    "literal reading, 0.15 is calibrated by us to the published errors.",
    population=50,
    iterations=200,
    planner_population=12,
    planner_iterations=25,
    evaluations="N + N T (variant local), N + 2 N T (both)",
    module="ikplan.ik.metaheuristics.ik_ba",
    kernel="ik_ba",
    params_type="IkBaParams",
    parameters=[
        number("fmin", 0.0, "Smallest frequency, Eq. 5.", minimum=None),
        number("fmax", 2.0, "Largest frequency, Eq. 5.", minimum=None),
        fraction("alpha", 0.97, "Loudness factor, Eq. 9."),
        number("gamma", 0.1, "Rise of the pulse rate, Eq. 10."),
        number("A0", 1.0, "Initial loudness."),
        fraction("r0", 1.0, "Limit of the pulse rate."),
        number(
            "eps_scale",
            1.0,
            "Factor of the noise of Eq. 14: 1 literal, 0.15 calibrated.",
            unit="rad or m",
        ),
        choice(
            "noise",
            ["uniform", "normal"],
            "Distribution of eps in Eq. 14: uniform in [-1, 1), or standard normal.",
        ),
        choice(
            "variant",
            ["local", "both", "both_attract"],
            "Which candidates are evaluated: Eq. 14 only; Eqs. 7 and 13 as well; the same with "
            "the sign of Eq. 13 turned.",
        ),
        choice(
            "accept",
            ["greedy", "loudness"],
            "Keep every better candidate, or only with the probability of the loudness.",
        ),
        number("first_t", 1, "The t of the first iteration.", maximum=1),
        *common_parameters("individual"),
    ],
)


def _bat_parameters(
    frequency: tuple[float, float],
    alpha: float,
    gamma: float,
    loudness: tuple[float, float],
    rate: tuple[float, float],
    warm: str,
) -> list[Parameter]:
    return [
        number("fmin", frequency[0], "Smallest frequency, Eq. 5.", minimum=None),
        number("fmax", frequency[1], "Largest frequency, Eq. 5.", minimum=None),
        fraction("alpha", alpha, "Loudness factor, Eq. 9."),
        number("gamma", gamma, "Rise of the pulse rate, Eq. 10."),
        number("A_low", loudness[0], "Smallest initial loudness of a bat."),
        number("A_high", loudness[1], "Largest initial loudness of a bat."),
        fraction("r0_low", rate[0], "Smallest limit of a bat's pulse rate."),
        fraction("r0_high", rate[1], "Largest limit of a bat's pulse rate."),
        choice(
            "sign",
            ["attract", "literal"],
            "Bats fly towards the best position, or away from it, as Eq. 6 is printed.",
        ),
        choice(
            "accept",
            ["own", "best"],
            "A bat moves when the candidate is better than its own position, or than the best.",
        ),
        choice(
            "decay",
            ["accept", "iteration"],
            "Loudness and pulse rate of a bat change when it moves, or of all in each iteration.",
        ),
        *common_parameters(warm),
    ]


_BA = Solver(
    name="ba",
    title="Bat algorithm (BA), parameters of Slim et al.",
    source=f"{SLIM}, Algorithm 1, Eqs. 5-10, Table 1",
    family="metaheuristic",
    notes="Badly tuned as given: with alpha 0.5 a bat falls silent after a few moves. Compare with "
    "alpha 0.97 and gamma 0.1.",
    population=50,
    iterations=200,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.metaheuristics.bat",
    kernel="bat",
    params_type="BatParams",
    parameters=_bat_parameters((0.0, 2.0), 0.5, 0.5, (0.0, 1.0), (0.001, 0.001), "cold"),
)

_BAT = Solver(
    name="bat",
    title="Bat algorithm (BAT), parameters of Kanagaraj et al.",
    source=f"{KANAGARAJ}, Eqs. 4-9, Table 2",
    family="metaheuristic",
    notes="The published error level is not reached by the printed equations, with either decay.",
    population=60,
    iterations=100,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.metaheuristics.bat",
    kernel="bat",
    params_type="BatParams",
    parameters=_bat_parameters((-0.05, 0.05), 0.97, 0.1, (1.0, 2.0), (0.0, 1.0), "individual"),
)

BATS = [_IK_BA, _BA, _BAT]
