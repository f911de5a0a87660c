"""Moves of MotionBenchMaker: how often, how fast, how short, and whether they touch anything."""
