"""The bat algorithms."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import KANAGARAJ, SLIM, choice, fraction, number
from ikplan.ik.solver import Parameter, Preset, Solver, common_parameters

__all__ = ["BATS"]

_IK_BA_PRESETS = {
    "slim": Preset(source=f"{SLIM}, Table 1", values={}, population=50, iterations=200),
    "bat-code": Preset(
        source=f"{SLIM}, Table 1, with the noise of bat code in circulation that, like Eqs. 9 and "
        "10, has one loudness for all bats: x* + 0.1 randn A. Who wrote that code first is not "
        "known to us; with it the published errors come out, and no constant is fitted",
        values={"noise": "normal", "eps_scale": 0.1},
        population=50,
        iterations=200,
    ),
}

_IK_BA = Solver(
    name="ik-ba",
    title="Bat algorithm for inverse kinematics (IK-BA)",
    source=f"{SLIM}, section 4.2, Algorithm 2, Table 1",
    family="metaheuristic",
    notes="eps of Eq. 14 is, in words, a number in [-1, 1] from a normal distribution, which "
    "contradicts itself. The default, also of the planner, is uniform in [-1, 1): six to nine "
    "times the published errors, which the refinement takes away. The preset bat-code reaches the "
    "published median.",
    population=50,
    iterations=200,
    planner_population=12,
    planner_iterations=25,
    evaluations="N + N T (variant local), N + 2 N T (the others)",
    presets=_IK_BA_PRESETS,
    module="ikplan.ik.metaheuristics.ik_ba",
    kernel="ik_ba",
    params_type="IkBaParams",
    parameters=[
        choice("preset", list(_IK_BA_PRESETS), "Which noise Eq. 14 has; all else is Table 1."),
        number("fmin", 0.0, "Smallest frequency, Eq. 5.", minimum=None),
        number("fmax", 2.0, "Largest frequency, Eq. 5.", minimum=None),
        fraction("alpha", 0.97, "Loudness factor, Eq. 9."),
        number("gamma", 0.1, "Rise of the pulse rate, Eq. 10."),
        number("A0", 1.0, "Initial loudness."),
        fraction("r0", 1.0, "Limit of the pulse rate."),
        number("eps_scale", 1.0, "Factor of the noise of Eq. 14.", unit="rad or m"),
        choice(
            "noise",
            ["uniform", "normal", "truncated"],
            "Distribution of eps in Eq. 14: uniform in [-1, 1), standard normal, or standard "
            "normal within [-1, 1].",
        ),
        choice(
            "variant",
            ["local", "both", "both_attract", "overwritten"],
            "Which candidates are evaluated: those of Eq. 14 only; also bats that fly by Eqs. 7 "
            "and 13, from where they are; the same with the sign of Eq. 13 turned; from where Eq. "
            "14 puts them, as Algorithm 2 overwrites them. The last three evaluate two candidates "
            "a bat, Algorithm 2 one.",
        ),
        choice(
            "accept",
            ["greedy", "loudness"],
            "Keep every better candidate, or only with the probability of the loudness.",
        ),
        number("first_t", 1, "The t of the first iteration.", maximum=1),
        choice(
            "beta",
            ["component", "bat"],
            "Eq. 5 draws a vector, as printed, or one number a bat; local does not use it.",
        ),
        choice(
            "draws",
            ["component", "bat"],
            "eps of Eq. 14 is drawn for every joint, or once a bat.",
        ),
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
    literal: tuple[str, str, str],
) -> list[Parameter]:
    beta, noise, first_rate = literal
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
        Parameter(
            name="beta",
            default=beta,
            choices=["bat", "component"],
            description="Eq. 5 draws one number a bat, or a vector, as Slim et al. print.",
        ),
        choice(
            "loudness",
            ["mean", "own"],
            "A^t of Eq. 8: the mean over the bats, as Kanagaraj et al. say, or the bat's own.",
        ),
        Parameter(
            name="noise",
            default=noise,
            choices=["component", "bat"],
            description="eps of Eq. 8 is drawn for every component, or once a bat, as Kanagaraj "
            "et al. print.",
        ),
        choice(
            "record",
            ["always", "accepted"],
            "The best position is that of every candidate seen, or of those that pass the test of "
            "the loudness, as Algorithm 1 is printed.",
        ),
        Parameter(
            name="rate",
            default=first_rate,
            choices=["zero", "limit"],
            description="Pulse rate until a bat moves: 0, as Eq. 10 gives it, or its limit.",
        ),
        choice(
            "reading",
            ["printed", "shared"],
            "As printed, or as circulating bat code has it: one loudness and pulse rate for all, "
            "the walk x* + 0.1 N(0, 1) A where U < r, moves kept where U > A.",
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
    parameters=_bat_parameters(
        (0.0, 2.0),
        0.5,
        0.5,
        (0.0, 1.0),
        (0.001, 0.001),
        "cold",
        ("component", "component", "limit"),
    ),
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
    parameters=_bat_parameters(
        (-0.05, 0.05), 0.97, 0.1, (1.0, 2.0), (0.0, 1.0), "individual", ("bat", "bat", "zero")
    ),
)

BATS = [_IK_BA, _BA, _BAT]
