"""Robots from URDF and SRDF, read as XML that is not trusted."""
