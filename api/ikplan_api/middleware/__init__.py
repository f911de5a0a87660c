"""Middleware around every request, from access control to the access log."""
