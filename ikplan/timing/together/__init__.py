"""Timing of many short spans, each from rest to rest, as one problem."""
