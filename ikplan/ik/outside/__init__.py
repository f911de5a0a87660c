"""Solvers from outside: what they minimise, and how they enter the registry."""
