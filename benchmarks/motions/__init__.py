"""Motions with more asked for than to be fast: studies."""
