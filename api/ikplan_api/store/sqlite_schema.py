"""Tables, triggers and pragmas of the SQLite file."""

from __future__ import annotations

__all__ = ["ADDED", "OPEN", "SCHEMA", "SHARED", "UPGRADE", "VERSION"]

VERSION = 2
"""Version of the file's content."""
# Pages of what is deleted can be given back only in a file that was made so. Documents are long: in
# pages of 16 KiB one takes two thirds of the processor time that it takes in the usual 4 KiB, while
# larger pages make the small changes dear. A file keeps the pages that it was made with.
OPEN = """
PRAGMA page_size = 16384;
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA auto_vacuum = INCREMENTAL;
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
"""
_PLANS = """
CREATE TABLE plans (
    id TEXT PRIMARY KEY, bytes INTEGER NOT NULL, made REAL NOT NULL, used REAL NOT NULL
);
CREATE TABLE documents (id TEXT PRIMARY KEY, document BLOB NOT NULL);
CREATE TABLE jobs (
    place INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, kind TEXT NOT NULL,
    budget_s REAL NOT NULL, accepted REAL NOT NULL, problem BLOB, robot BLOB,
    document BLOB NOT NULL
);
CREATE TABLE robots (
    name TEXT PRIMARY KEY, bytes INTEGER NOT NULL, used REAL NOT NULL, document BLOB NOT NULL,
    info BLOB NOT NULL
);
"""
"""The first version. Documents have a table of their own: SQLite rewrites a whole row on every
change, and each use of a plan changes its row."""
_SCENES = """
CREATE TABLE IF NOT EXISTS scenes (
    name TEXT PRIMARY KEY, bytes INTEGER NOT NULL, used REAL NOT NULL, document BLOB NOT NULL,
    info BLOB NOT NULL{more}
);
"""
_OWNERS = f"""
ALTER TABLE plans ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE plans ADD COLUMN kind TEXT NOT NULL DEFAULT 'plan';
ALTER TABLE plans ADD COLUMN robot TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE jobs ADD COLUMN robot_name TEXT NOT NULL DEFAULT '';
ALTER TABLE robots ADD COLUMN owner TEXT NOT NULL DEFAULT '';
ALTER TABLE scenes ADD COLUMN owner TEXT NOT NULL DEFAULT '';
CREATE TABLE facts (name TEXT PRIMARY KEY, value TEXT NOT NULL);
DROP INDEX IF EXISTS plans_by_use;
CREATE INDEX plans_by_use ON plans (used, id, bytes);
CREATE INDEX plans_by_owner ON plans (owner, made, id);
CREATE INDEX plans_by_age ON plans (made);
CREATE INDEX jobs_by_owner ON jobs (owner, accepted, id);
DROP VIEW IF EXISTS kept;
CREATE VIEW kept AS SELECT id, made, document, owner, kind, robot
    FROM plans JOIN documents USING (id);
CREATE TRIGGER keep INSTEAD OF INSERT ON kept BEGIN
    INSERT INTO documents VALUES (NEW.id, NEW.document)
        ON CONFLICT (id) DO UPDATE SET document = excluded.document;
    INSERT INTO plans (id, bytes, made, used, owner, kind, robot)
        VALUES (NEW.id, length(NEW.document), NEW.made, NEW.made, NEW.owner, NEW.kind, NEW.robot)
        ON CONFLICT (id) DO UPDATE SET
            bytes = excluded.bytes, made = excluded.made, used = excluded.used;
    DELETE FROM jobs WHERE id = NEW.id;
END;
PRAGMA user_version = {VERSION};
"""
"""The second version: who owns what, of which robot, and indices for lists and for the purge. The
names ``id`` and ``name`` are scoped by their owner, see :mod:`ikplan_api.store.owners`."""
SCHEMA = f"""
BEGIN IMMEDIATE;
{_PLANS}
{_SCENES.format(more="")}
CREATE TRIGGER forget AFTER DELETE ON plans BEGIN
    DELETE FROM documents WHERE id = OLD.id;
END;
{_OWNERS}
COMMIT;
"""
"""A new file."""
SHARED = "shared"
"""The fact that all keys shared the file when it was begun."""
UPGRADE = f"""
BEGIN IMMEDIATE;
{_SCENES.format(more="")}
{_OWNERS}
INSERT INTO facts VALUES ('{SHARED}', '1');
COMMIT;
VACUUM;
"""
"""From the first version to the second; the file is written anew, so that it can shrink later."""
ADDED = (
    _SCENES.format(more=", owner TEXT NOT NULL DEFAULT ''")
    + """
CREATE TABLE IF NOT EXISTS attempts (id TEXT PRIMARY KEY, begun INTEGER NOT NULL);
CREATE TRIGGER IF NOT EXISTS forget_attempts AFTER DELETE ON jobs BEGIN
    DELETE FROM attempts WHERE id = OLD.id;
END;
CREATE TRIGGER IF NOT EXISTS failed AFTER UPDATE OF problem ON jobs BEGIN
    DELETE FROM attempts WHERE id = NEW.id;
END;
CREATE TABLE IF NOT EXISTS audit (
    place INTEGER PRIMARY KEY AUTOINCREMENT, time REAL NOT NULL, owner TEXT NOT NULL,
    action TEXT NOT NULL, subject TEXT NOT NULL, robot TEXT NOT NULL
);
CREATE INDEX IF NOT EXISTS audit_by_owner ON audit (owner, place);
CREATE TRIGGER IF NOT EXISTS audit_accepted AFTER INSERT ON jobs BEGIN
    INSERT INTO audit (time, owner, action, subject, robot)
        VALUES (NEW.accepted, NEW.owner, 'accepted', {job}, NEW.robot_name);
END;
CREATE TRIGGER IF NOT EXISTS audit_failed AFTER UPDATE OF problem ON jobs BEGIN
    INSERT INTO audit (time, owner, action, subject, robot)
        VALUES ((julianday('now') - 2440587.5) * 86400.0, NEW.owner, 'failed', {job},
            NEW.robot_name);
END;
CREATE TRIGGER IF NOT EXISTS audit_finished AFTER INSERT ON plans BEGIN
    INSERT INTO audit (time, owner, action, subject, robot)
        VALUES (NEW.made, NEW.owner, 'finished', {job}, NEW.robot);
END;
""".format(job="substr(NEW.id, instr(NEW.id, ':') + 1)")
)
"""Tables and triggers that a file of the same version may lack. Attempts are apart from their jobs:
SQLite would rewrite the documents of a job with its row."""
