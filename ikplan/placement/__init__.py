"""Placement: where to put the part or the robot so that a path is feasible, and best."""
