"""The robots that ``python -m catalogue`` writes, against the facts of their sources."""
