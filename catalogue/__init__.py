"""Writes the robots of ``robots/`` that come from published descriptions, out of ``facts.yaml``."""
