"""Searches of no paper of the report: the references of a reader of today."""

from __future__ import annotations

from ikplan.ik.catalogue.sources import choice, fraction, number
from ikplan.ik.solver import Solver, common_parameters

__all__ = ["BASELINES"]

_CMA_ES = Solver(
    name="cma-es",
    title="CMA-ES with restarts of a growing population (IPOP), active update",
    source="Hansen, The CMA Evolution Strategy: A Tutorial, arXiv:1604.00772; restarts of Auger, "
    "Hansen, A Restart CMA Evolution Strategy With Increasing Population Size, 2005",
    family="metaheuristic",
    notes="Its generations are of 4 + 3 ln D candidates and more; N and T are the budget alone.",
    population=30,
    iterations=100,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.baselines.cma_es",
    kernel="cma_es",
    params_type="CmaParams",
    parameters=[
        fraction("sigma", 0.25, "First step size, as a fraction of each joint's range."),
        number("growth", 2.0, "Factor of a generation at each restart.", minimum=1.0, maximum=10.0),
        number("tol_f", 1e-12, "It begins again once its values differ by less than this."),
        number("tol_x", 1e-12, "And once no step is longer, as a fraction of the joint's range."),
        *common_parameters(),
    ],
)

_L_SHADE = Solver(
    name="l-shade",
    title="L-SHADE, adaptive differential evolution with a population that shrinks",
    source="Tanabe, Fukunaga, Improving the Search Performance of SHADE Using Linear Population "
    "Size Reduction, IEEE Congress on Evolutionary Computation 2014",
    family="metaheuristic",
    notes="Its population is 18 a joint at first and 4 at last; N and T are the budget alone.",
    population=30,
    iterations=100,
    min_population=4,
    planner_population=20,
    planner_iterations=30,
    evaluations="N + N T",
    module="ikplan.ik.baselines.l_shade",
    kernel="l_shade",
    params_type="LShadeParams",
    parameters=[
        number("per_joint", 18.0, "Individuals at first, by the number of joints.", maximum=1000.0),
        fraction("p", 0.11, "Share of the best of which a mutant follows one."),
        number("memory", 6, "Places of the memory of factors.", minimum=1, maximum=100),
        number("archive", 2.6, "Parents kept, by the population.", maximum=10.0),
        choice(
            "repair",
            ["midpoint", "bounds"],
            "A component outside goes half-way to the bound, or as `bounds` says.",
        ),
        *common_parameters(),
    ],
)

BASELINES = [_CMA_ES, _L_SHADE]
