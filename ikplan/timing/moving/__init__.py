"""Motions that begin or end moving: the path speed at both ends is given."""
