"""Moves on which the tool keeps within a cone or a box."""
