"""Timing: limits kept, distance from the optimum, and cost, over random paths."""
