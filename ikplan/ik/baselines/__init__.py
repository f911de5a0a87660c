"""Searches that no paper of the report has: what a reader of today compares with."""
