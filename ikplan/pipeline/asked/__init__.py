"""Motions with more asked for than to be fast: moving ends, durations, times, dwells, events."""
