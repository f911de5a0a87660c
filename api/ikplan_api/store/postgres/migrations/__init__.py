"""Migrations of the database, run by Alembic when a replica starts."""
