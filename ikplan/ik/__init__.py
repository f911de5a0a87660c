"""Inverse kinematics: objectives, metaheuristics, refinement, the solver registry."""

from ikplan.ik.registry import find_solver, solvers
from ikplan.ik.solve import PoseSolver
from ikplan.ik.solver import Solver

__all__ = ["PoseSolver", "Solver", "find_solver", "solvers"]
