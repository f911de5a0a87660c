"""Uploaded scenes."""
