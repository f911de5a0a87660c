"""The searches, one file an algorithm family; see :mod:`ikplan.ik.registry` for their names."""
