"""Inverse kinematics: objectives, metaheuristics, refinement, the solver registry."""

from ikplan.ik.registry import Solver, find_solver, solvers
from ikplan.ik.solve import PoseSolver, solve_ik

__all__ = ["PoseSolver", "Solver", "find_solver", "solve_ik", "solvers"]
