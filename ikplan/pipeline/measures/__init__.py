"""Measures of finished plans."""
