"""Figures of plans and timings."""
