"""What Alembic runs: every migration that is missing, by one replica at a time."""

from __future__ import annotations

from alembic import context
from sqlalchemy import text

_LOCK = 0x696B706C616E
"""Number of the advisory lock: the letters of ikplan."""


def _run() -> None:
    connection = context.config.attributes["connection"]
    context.configure(connection=connection, version_table="ikplan_version")
    with context.begin_transaction():
        # Another replica that starts at the same time waits here, and then finds nothing to do.
        connection.execute(text(f"SELECT pg_advisory_xact_lock({_LOCK})"))
        context.run_migrations()


_run()
