"""The tour through one node of each cluster: a generalised travelling salesman, by OR-tools.

The routing solver of OR-tools, one thread: the cheapest arcs first, then guided local search (C.
Voudouris and E. Tsang, "Guided local search and its application to the traveling salesman
problem", European Journal of Operational Research 113, 1999), ended by a number of steps, never by
the clock.
"""

from __future__ import annotations

import importlib
from typing import Any

import numpy as np

from ikplan.arrays import Array, Indices
from ikplan.errors import InvalidRequest

__all__ = ["shortest_tour"]

_STEPS = 1000
"""Neighbours that the search rejects before it ends."""
_UNIT = 1e6
"""Parts of a unit of cost that the solver tells apart: it counts in whole numbers."""
_HOURS = 24 * 3600
"""Beyond any time budget: the solver asks for a limit, and the steps end it long before [s]."""


def shortest_tour(costs: Array, cluster: Indices) -> list[int]:
    """Return a short tour from node 0 through one node of every cluster to the last node.

    Args:
        costs: Cost from node to node, shape (n, n).
        cluster: Cluster of each node, shape (n,); of the first and the last -1.

    Returns:
        The nodes between the first and the last, one of each cluster, in order.

    Raises:
        InvalidRequest: OR-tools is not installed.
    """
    solver, enums = _routing()
    count = len(costs)
    manager = solver.RoutingIndexManager(count, 1, [0], [count - 1])
    model = solver.RoutingModel(manager)
    whole = np.rint(costs * _UNIT).astype(np.int64)
    model.SetArcCostEvaluatorOfAllVehicles(model.RegisterTransitMatrix(whole.tolist()))
    left_out = int(whole.max()) * count + 1
    for k in range(int(cluster.max()) + 1):
        nodes = [manager.NodeToIndex(int(node)) for node in np.flatnonzero(cluster == k)]
        model.AddDisjunction(nodes, left_out)
    parameters = solver.DefaultRoutingSearchParameters()
    parameters.first_solution_strategy = enums.FirstSolutionStrategy.PATH_CHEAPEST_ARC
    parameters.local_search_metaheuristic = enums.LocalSearchMetaheuristic.GUIDED_LOCAL_SEARCH
    parameters.time_limit.seconds = _HOURS
    model.AddSearchMonitor(model.solver().FailuresLimit(_STEPS))
    solution = model.SolveWithParameters(parameters)
    index, nodes = solution.Value(model.NextVar(model.Start(0))), []
    while not model.IsEnd(index):
        nodes.append(int(manager.IndexToNode(index)))
        index = solution.Value(model.NextVar(index))
    return nodes


def _routing() -> tuple[Any, Any]:
    """The routing solver and its enumerations.

    Raises:
        InvalidRequest: OR-tools is not installed.
    """
    try:
        solver = importlib.import_module("ortools.constraint_solver.pywrapcp")
        enums = importlib.import_module("ortools.constraint_solver.routing_enums_pb2")
    except ModuleNotFoundError as error:
        raise InvalidRequest(
            "path.order: a free order is found by OR-tools, which is not installed: "
            'pip install "ikplan[order]"',
            field="path.order",
            allowed=["given"],
        ) from error
    return solver, enums
