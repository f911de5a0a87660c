"""Reach maps: where an arm brings its tool, in which orientations, how well and how clear."""
