"""Placement of parts: searches compared with the planner as their objective."""
