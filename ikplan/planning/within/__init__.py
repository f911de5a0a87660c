"""Tracking within the tolerance, where a tool path cannot be tracked exactly."""
