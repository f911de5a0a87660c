"""The robots of random requests and of tests too long for the whole catalogue."""

from __future__ import annotations

__all__ = ["REFERENCE_ROBOTS"]

REFERENCE_ROBOTS = (
    "baxter_left", "baxter_physical", "baxter_right", "baxter_table7", "dobot_magician", "eod_arm",
    "fr3", "iiwa14", "kinova_j2s6s200", "mh5", "panda", "so101", "tiago", "ur10", "ur10e", "ur3",
    "ur3e", "ur5", "ur5e", "xarm7", "z1",
)  # fmt: skip
"""Chains of every kind; fixed, so that a new robot changes no request of a seed and number."""
