"""Differential evolution and its relatives."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import LI, SLIM, choice, fraction, number
from ikplan.ik.solver import Parameter, Preset, Solver, common_parameters

__all__ = ["DIFFERENTIAL"]

_F = number("F", 0.9, "Factor of the (first) difference.", maximum=2.0)
_LAMBDA = number("lam", 0.1, "Factor lambda of the second difference.", maximum=2.0)
_CR = fraction("CR", 0.5, "Probability that a component comes from the mutant.")


def _strategy(
    name: str, strategy: int, mutant: str, least: int, notes: str, slim: bool = False
) -> Solver:
    presets = {
        "li": Preset(source=f"{LI}, section 4", values={}, population=30, iterations=100),
        "slim": Preset(
            source=f"{SLIM}, Table 1, after Lopez-Franco et al. 2018; the strategy is not named",
            values={"F": 0.6, "CR": 0.9},
            population=50,
            iterations=200,
        ),
    }
    preset = [choice("preset", list(presets), "Whose parameters are the defaults, and N and T.")]
    return Solver(
        name=f"de-{name}",
        title=f"Differential evolution DE/{'/'.join(name.rsplit('-', 1))}/bin: {mutant}",
        source=f"{LI}, Eqs. 13-17",
        family="metaheuristic",
        notes=notes,
        population=30,
        iterations=100,
        min_population=least,
        planner_population=20,
        planner_iterations=30,
        evaluations="N + N T",
        presets=presets if slim else {},
        module="ikplan.ik.metaheuristics.differential",
        kernel="de",
        params_type="DeParams",
        fixed={"strategy": strategy},
        parameters=[*(preset if slim else []), _F, _LAMBDA, _CR, *common_parameters()],
    )


_SDE = Solver(
    name="sde",
    title="Self-adaptive differential evolution (SDE)",
    source="Omran, Salman, Engelbrecht, Self-adaptive Differential Evolution, 2005; compared with "
    f"in {LI}",
    family="metaheuristic",
    notes="Li et al. print F 0.9 and CR 0.5; constant, they would make it DE/rand/1. Here 0.9 is "
    "the first factor and 0.5 the mean crossover rate, and both adapt. F_initial normal: Omran's.",
    population=30,
    iterations=100,
    min_population=4,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.metaheuristics.adaptive_differential",
    kernel="sde",
    params_type="SdeParams",
    parameters=[
        Parameter(
            name="F_initial",
            default="fixed",
            choices=["normal", "fixed"],
            description="First factors: drawn, as Omran et al. do, or all equal to F.",
        ),
        number("F", 0.9, "First factor, where it is fixed.", maximum=2.0),
        number("F_mean", 0.5, "Mean of the first factors drawn.", maximum=2.0),
        number("F_deviation", 0.15, "Standard deviation of the first factors drawn.", maximum=2.0),
        number(
            "change_deviation",
            0.5,
            "Standard deviation of the factor of the difference of two factors.",
            maximum=2.0,
        ),
        fraction("CR_mean", 0.5, "Mean of the crossover rate."),
        fraction("CR_deviation", 0.15, "Standard deviation of the crossover rate."),
        *common_parameters(),
    ],
)

_ODE = Solver(
    name="ode",
    title="Opposition-based differential evolution (ODE)",
    source="Rahnamayan, Tizhoosh, Salama, Opposition-Based Differential Evolution, IEEE "
    f"Transactions on Evolutionary Computation 2008, 12(1); F and CR of {LI}",
    family="metaheuristic",
    notes="The jump rate Jr is not in Li et al.",
    population=30,
    iterations=100,
    min_population=4,
    planner_population=16,
    planner_iterations=25,
    evaluations="2 N + (1 + Jr) N T on average",
    module="ikplan.ik.metaheuristics.opposition",
    kernel="ode",
    params_type="OdeParams",
    parameters=[
        _F,
        _CR,
        fraction("Jr", 0.3, "Probability that a generation ends with the jump to its opposites."),
        *common_parameters(),
    ],
)

DIFFERENTIAL = [
    _strategy("rand-1", 0, "x_r1 + F (x_r2 - x_r3)", 4, "", slim=True),
    _strategy("best-1", 1, "x_best + F (x_r2 - x_r1)", 3, ""),
    _strategy("best-2", 2, "x_best + F (x_r1 - x_r2) + lambda (x_r3 - x_r4)", 5, ""),
    _strategy("rand-2", 3, "x_r1 + F (x_r2 - x_r3) + lambda (x_r4 - x_r5)", 6, ""),
    _strategy(
        "current-to-best-1",
        4,
        "x_j + F (x_best - x_j) + lambda (x_r1 - x_r2)",
        3,
        "With lambda 0.1 it contracts on the best in a few generations; 0.5 for both is a control.",
    ),
    _SDE,
    _ODE,
]
