"""Limits other than those of single joints, as constraints along a path."""
