"""Rotations: SO(3), its kernels, and the shortest turn between two orientations."""
