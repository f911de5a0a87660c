"""The first version of the database."""

from __future__ import annotations

from alembic import op

revision = "0001"
down_revision = None

_TABLES = """
CREATE TABLE plans (
    owner text NOT NULL, id text NOT NULL, kind text NOT NULL, robot text NOT NULL,
    made timestamptz NOT NULL DEFAULT now(), used timestamptz NOT NULL DEFAULT now(),
    bytes bigint NOT NULL, document bytea, object text,
    PRIMARY KEY (owner, id), CHECK ((document IS NULL) <> (object IS NULL))
);
ALTER TABLE plans ALTER document SET STORAGE EXTERNAL;
CREATE INDEX plans_by_time ON plans (owner, made, id);
CREATE INDEX plans_by_use ON plans (used);
CREATE INDEX plans_by_age ON plans (made);
CREATE TABLE jobs (
    place bigint GENERATED ALWAYS AS IDENTITY, owner text NOT NULL, id text NOT NULL,
    kind text NOT NULL, document bytea NOT NULL, robot bytea, robot_name text NOT NULL,
    budget_s double precision NOT NULL, time timestamptz NOT NULL DEFAULT now(),
    accepted boolean NOT NULL, state text NOT NULL CHECK (state IN ('queued', 'running', 'failed')),
    replica text, attempt integer NOT NULL DEFAULT 0, lease_until timestamptz,
    stage text, done integer NOT NULL DEFAULT 0, total integer NOT NULL DEFAULT 0, problem bytea,
    PRIMARY KEY (owner, id)
);
CREATE INDEX jobs_queued ON jobs (place) WHERE state = 'queued';
CREATE INDEX jobs_running ON jobs (lease_until) WHERE state = 'running';
CREATE INDEX jobs_by_time ON jobs (owner, time, id);
CREATE TABLE uploads (
    kind text NOT NULL, owner text NOT NULL, name text NOT NULL, bytes bigint NOT NULL,
    used timestamptz NOT NULL DEFAULT clock_timestamp(), document bytea NOT NULL,
    info bytea NOT NULL, PRIMARY KEY (kind, owner, name)
);
CREATE TABLE audit (
    place bigint GENERATED ALWAYS AS IDENTITY PRIMARY KEY,
    time timestamptz NOT NULL DEFAULT now(), owner text NOT NULL, action text NOT NULL,
    subject text NOT NULL, robot text NOT NULL DEFAULT '', replica text NOT NULL DEFAULT '',
    attempt integer NOT NULL DEFAULT 0
);
CREATE INDEX audit_by_owner ON audit (owner, place);
CREATE INDEX audit_by_age ON audit (time);
"""


def upgrade() -> None:
    """Make the tables."""
    op.execute(_TABLES)


def downgrade() -> None:
    """Drop the tables, and all that is stored."""
    op.execute("DROP TABLE plans, jobs, uploads, audit")
