"""Uploaded robots: their upload, and their first build in a sandboxed process."""
