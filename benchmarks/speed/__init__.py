"""How fast it is, in calls of Pinocchio's forward kinematics: ``python -m benchmarks.speed``."""
