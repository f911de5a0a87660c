"""Robots by a definition of ours: robot.yaml, chains and DH tables."""
