"""Swarms: particles, bees, masses, whales."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import KANAGARAJ, LI, SLIM, choice, fraction, number
from ikplan.ik.solver import Parameter, Preset, Solver, common_parameters

__all__ = ["SWARMS"]

_PSO_PRESETS = {
    "slim": Preset(
        source=f"{SLIM}, Table 1, after Lopez-Franco et al. 2022",
        values={},
        population=50,
        iterations=200,
    ),
    "slim-permuted": Preset(
        source=f"{SLIM}, Table 1, its three numbers in another order: as printed no particle comes "
        "to rest, while Table 3 has a smallest error of 0.0000 cm",
        values={"w": 0.53514, "w_end": 0.53514, "c1": 1.1312, "c2": 2.0149},
        population=50,
        iterations=200,
    ),
    "kanagaraj": Preset(
        source=f"{KANAGARAJ}, Table 2; one pair of random numbers a particle, as printed",
        values={"draws": "particle", "w": 0.3033, "w_end": 0.3033, "c1": 2.4, "c2": 3.2},
        population=60,
        iterations=100,
    ),
    "li": Preset(
        source=f"{LI}, section 4; the inertia is not given",
        values={"w": 0.9, "w_end": 0.4, "c1": 1.2, "c2": 1.2},
        population=30,
        iterations=100,
    ),
}

_PSO = Solver(
    name="pso",
    title="Particle swarm optimisation (PSO)",
    source=f"{SLIM}, Table 1; presets of {KANAGARAJ} and {LI}",
    family="metaheuristic",
    notes="Table 1 of Slim et al. is a misprint, most likely: with an inertia above 1 no particle "
    "comes to rest; slim-permuted has nearly the printed results. v_max is ours: no paper has one.",
    population=50,
    iterations=200,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    presets=_PSO_PRESETS,
    module="ikplan.ik.metaheuristics.particle_swarm",
    kernel="pso",
    params_type="PsoParams",
    parameters=[
        choice("preset", list(_PSO_PRESETS), "Whose parameters are the defaults, and N and T."),
        number("w", 1.1312, "Inertia in the first iteration.", maximum=2.0),
        number("w_end", 1.1312, "Inertia in the last, linear in between.", maximum=2.0),
        number("c1", 2.0149, "Pull to a particle's own best position.", maximum=10.0),
        number("c2", 0.53514, "Pull to the swarm's best position.", maximum=10.0),
        number("v_max", 0.5, "Largest step, as a fraction of each joint's range; 0: unlimited."),
        choice(
            "draws",
            ["component", "particle"],
            "Fresh random numbers for every component, or one pair a particle, as Kanagaraj et al. "
            "print.",
        ),
        *common_parameters(),
    ],
)

_MO_PSO = Solver(
    name="mo-pso",
    title="Multi-objective particle swarm optimisation (MO-PSO) of error and elongation",
    source=f"{SLIM}, Table 1; Coello Coello, Pulido, Lechuga, Handling Multiple Objectives With "
    "Particle Swarm Optimization, IEEE Transactions on Evolutionary Computation 2004, 8(3)",
    family="metaheuristic",
    notes="Which candidate of the archive is reported, and how many it holds, is not stated.",
    population=50,
    iterations=200,
    min_population=3,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.metaheuristics.mo_pso",
    kernel="mo_pso",
    params_type="MoPsoParams",
    parameters=[
        number("w", 0.5, "Inertia.", maximum=2.0),
        number("c1", 2.0, "Pull to a particle's own best position.", maximum=10.0),
        number("c2", 2.0, "Pull to the leader.", maximum=10.0),
        number("grid", 20, "Divisions of each objective.", minimum=1, maximum=200),
        fraction("v_max", 0.05, "Largest velocity, as a fraction of each joint's range."),
        fraction("mutation", 0.5, "Share of the second third of the swarm that is drawn anew."),
        number("archive", 200, "Largest number of candidates kept.", minimum=2, maximum=10_000),
        choice(
            "choice",
            ["position", "knee"],
            "Candidate reported: the smallest position error, or the one nearest to the ideal "
            "point, both objectives scaled to [0, 1].",
        ),
        *common_parameters(),
    ],
)

_ABC = Solver(
    name="abc",
    title="Artificial bee colony (ABC), stand-in for K-ABC",
    source="Karaboga, Basturk, A powerful and efficient algorithm for numerical function "
    "optimization: artificial bee colony (ABC) algorithm, Journal of Global Optimization 2007, 39; "
    "guided move of Zhu, Kwong 2010",
    family="metaheuristic",
    notes="K-ABC (El-Sherbiny, Elhosseini, Haikal, Applied Soft Computing 2018, 73), which Slim et "
    "al. compare with, is not openly described; this is the standard algorithm in its place.",
    population=50,
    iterations=200,
    min_population=4,
    planner_population=20,
    planner_iterations=30,
    evaluations="N / 2 + N T, and one more in an iteration with a scout",
    module="ikplan.ik.metaheuristics.bee_colony",
    kernel="abc",
    params_type="AbcParams",
    parameters=[
        choice("move", ["standard", "guided"], "Whether the best source pulls."),
        number("psi_max", 1.5, "Largest pull to the best source, where it does.", maximum=10.0),
        choice("fitness", ["value", "rank"], "1 / (1 + scale f), or N - rank."),
        number("fitness_scale", 1000.0, "Brings the objective into the fitness's unit: mm."),
        number("limit_factor", 1.0, "A source is left after this times SN D failures."),
        *common_parameters(),
    ],
)

_GSA = Solver(
    name="gsa",
    title="Gravitational search algorithm (GSA)",
    source=f"{KANAGARAJ}, Eqs. 10-18 (Eq. 11 corrected), Table 2",
    family="metaheuristic",
    notes="With alpha 1 gravity hardly falls; Rashedi et al. use 20. The published error level is "
    "not reached with either. What happens at the bounds is not printed: `bounds` clips, "
    "`resample` draws anew.",
    population=60,
    iterations=100,
    min_population=2,
    planner_population=16,
    planner_iterations=25,
    evaluations="N T",
    module="ikplan.ik.metaheuristics.gravitational",
    kernel="gsa",
    params_type="GsaParams",
    parameters=[
        number("G0", 100.0, "Gravity at the start, Eq. 10."),
        number("alpha", 1.0, "How fast gravity falls, Eq. 10."),
        fraction("K_end", 0.02, "Share of the individuals that still attract at the end."),
        *common_parameters(),
    ],
)

_WOA = Solver(
    name="woa",
    title="Whale optimisation algorithm (WOA)",
    source=f"{KANAGARAJ}, Eqs. 19-23, Table 2; Mirjalili, Lewis, The Whale Optimization Algorithm, "
    "Advances in Engineering Software 2016, 95",
    family="metaheuristic",
    notes="b 5 throws many spiral moves beyond the bounds; 1 is usual.",
    population=60,
    iterations=100,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.metaheuristics.whale",
    kernel="woa",
    params_type="WoaParams",
    parameters=[
        number("b", 5.0, "Shape of the spiral.", maximum=50.0),
        Parameter(
            name="literal",
            default=False,
            description="Eqs. 19 and 20 as printed: no absolute value, always towards the best.",
        ),
        *common_parameters(),
    ],
)

SWARMS = [_PSO, _MO_PSO, _ABC, _GSA, _WOA]
