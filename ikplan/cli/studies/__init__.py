"""Commands that study solvers."""
