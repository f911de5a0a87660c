"""The golden list: a digest of every trajectory that a change of structure must leave alone."""
