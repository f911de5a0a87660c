"""Capacity: how many cores, how much memory and storage a load takes."""
