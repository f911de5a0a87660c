"""Curves: arcs, splines, waves and roses, and their arc length."""
