"""Batches of many plans: resumed after kills, memory, and one executor beside another."""
