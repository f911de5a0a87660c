"""The cuckoo search, the genetic algorithm, and BODE-CS."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import LI, choice, fraction, number
from ikplan.ik.solver import Parameter, Solver, common_parameters

__all__ = ["EVOLUTION"]

_LEVY = number("beta", 1.5, "Exponent of the Levy law, Eq. 34.", minimum=0.3, maximum=1.99)

_CS = Solver(
    name="cs",
    title="Cuckoo search (CS)",
    source=f"{LI}, Eqs. 29-35; Yang, Deb, Cuckoo Search via Levy Flights, 2009",
    family="metaheuristic",
    notes="Twice the evaluations of the others per iteration. Eqs. 30-31 (the global walk) are a "
    "density, not a step, and are not used; so alpha_g is not either.",
    population=30,
    iterations=100,
    planner_population=12,
    planner_iterations=25,
    evaluations="N + 2 N T",
    module="ikplan.ik.metaheuristics.cuckoo",
    kernel="cs",
    params_type="CsParams",
    parameters=[
        fraction("Pa", 0.25, "A component moves where its random number exceeds Pa, Eq. 35."),
        number("alpha_l", 0.01, "Factor of the Levy step, Eq. 29."),
        _LEVY,
        Parameter(
            name="heaviside",
            default=False,
            description="Keep the factor H(Pa - U) of Eq. 29 in the Levy step.",
        ),
        Parameter(
            name="normal_factor",
            default=False,
            description="Multiply the Levy step by a standard normal number, as Yang's and Deb's "
            "code does and Eq. 29 does not.",
        ),
        *common_parameters(),
    ],
)

_GA = Solver(
    name="ga",
    title="Real-coded genetic algorithm (GA), operators ours",
    source=f"{LI}, section 4 (N, T, Pm, Pc); operators not given there",
    family="metaheuristic",
    population=30,
    iterations=100,
    min_population=2,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + (N - elites) T",
    module="ikplan.ik.metaheuristics.genetic",
    kernel="ga",
    params_type="GaParams",
    parameters=[
        fraction("Pc", 0.4, "Probability of crossover, per pair."),
        fraction("Pm", 0.2, "Probability of mutation, per individual."),
        number("tournament", 2, "Competitors for being a parent.", minimum=1, maximum=1000),
        number("blend", 0.5, "Reach of a child beyond its parents (BLX-alpha).", maximum=10.0),
        choice("mutation", ["uniform", "gaussian"], "One gene is drawn anew, or shifted normally."),
        fraction("mutation_deviation", 0.1, "Deviation of the shift, by the joint's range."),
        number("elites", 1, "Best individuals carried over, fewer than N.", maximum=1000),
        *common_parameters(),
    ],
)

_BODE_CS = Solver(
    name="bode-cs",
    title="Bidirectional opposite differential evolution and cuckoo search (BODE-CS)",
    source=f"{LI}, section 3, Eqs. 18-42, Algorithm 2",
    family="metaheuristic",
    notes="Eq. 27 is read with fractions. F of Eq. 23 never lies within [Fmin, Fmax] as printed, "
    "yet only the printed form gives the published errors.",
    population=30,
    iterations=100,
    min_population=4,
    planner_population=14,
    planner_iterations=30,
    evaluations="2 N + N T to 2.35 N T",
    module="ikplan.ik.metaheuristics.bode_cs",
    kernel="bode_cs",
    params_type="BodeCsParams",
    parameters=[
        number("lam", 0.1, "Factor lambda of the second difference.", maximum=2.0),
        number("Fmax", 0.9, "Eq. 23.", maximum=2.0),
        number("Fmin", 0.5, "Eq. 23.", maximum=2.0),
        fraction("Cmax", 0.8, "Crossover rate at the end, Eq. 24."),
        fraction("Cmin", 0.5, "Crossover rate at the start."),
        number("alpha_l", 0.01, "Factor of the Levy step, Eq. 29."),
        _LEVY,
        number("w_j", 0.7, "Weight of the nest, Eq. 37."),
        number("w_gbest", 0.3, "Weight of the best nest, Eq. 37."),
        fraction("Co", 0.2, "Probability of opposition at the start, Eq. 36."),
        fraction("Cbi", 0.15, "Probability of the pull to the best, Eq. 38."),
        fraction("Ccsor", 0.05, "Largest relative shift of an opposite, Eq. 26."),
        fraction("Pamax", 0.25, "Pa at the start, Eq. 41."),
        fraction("Pamin", 0.05, "Pa at the end."),
        choice("scaling", ["printed", "plus_fmin"], "F of Eq. 23: as printed, or plus Fmin."),
        Parameter(
            name="exclude_self",
            default=False,
            description="Whether r1, r2, r3 differ from j as well as from each other.",
        ),
        choice(
            "generation",
            ["in_place", "synchronous"],
            "A better trial takes its place, and the best, at once, as the loops of Algorithm 2 "
            "have it; or mutants are made of x(t), as Eqs. 17 and 28 are printed.",
        ),
        Parameter(
            name="heaviside",
            default=False,
            description="Keep the factor H(Pa - U) of Eq. 29 in the Levy step.",
        ),
        *common_parameters(),
    ],
)

EVOLUTION = [_CS, _GA, _BODE_CS]
