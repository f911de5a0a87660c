"""Requests about single poses, and how joint values are looked for: a file each."""
