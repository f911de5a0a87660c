"""Jerk-limited timing: smoothing, its kernels, and cubic motions."""
