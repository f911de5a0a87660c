"""Imported once by the process that workers are forked from, by kind of request: born warm."""
