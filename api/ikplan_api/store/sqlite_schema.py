"""Tables, triggers and pragmas of the SQLite file."""

from __future__ import annotations

__all__ = ["ADDED", "OPEN", "SCHEMA", "VERSION"]

VERSION = 1
"""Version of the file's content."""
OPEN = """
PRAGMA locking_mode = EXCLUSIVE;
PRAGMA journal_mode = WAL;
PRAGMA synchronous = NORMAL;
"""
# Documents have a table of their own: SQLite rewrites a whole row on every change, and each use
# of a plan changes its row.
SCHEMA = f"""
BEGIN IMMEDIATE;
DROP TABLE IF EXISTS plans;
CREATE TABLE plans (
    id TEXT PRIMARY KEY, bytes INTEGER NOT NULL, made REAL NOT NULL, used REAL NOT NULL
);
CREATE INDEX plans_by_use ON plans (used, id, bytes);
CREATE TABLE documents (id TEXT PRIMARY KEY, document BLOB NOT NULL);
CREATE TABLE IF NOT EXISTS jobs (
    place INTEGER PRIMARY KEY AUTOINCREMENT, id TEXT NOT NULL UNIQUE, kind TEXT NOT NULL,
    budget_s REAL NOT NULL, accepted REAL NOT NULL, problem BLOB, robot BLOB,
    document BLOB NOT NULL
);
CREATE TABLE IF NOT EXISTS robots (
    name TEXT PRIMARY KEY, bytes INTEGER NOT NULL, used REAL NOT NULL, document BLOB NOT NULL,
    info BLOB NOT NULL
);
CREATE VIEW kept AS SELECT id, made, document FROM plans JOIN documents USING (id);
CREATE TRIGGER keep INSTEAD OF INSERT ON kept BEGIN
    INSERT INTO documents VALUES (NEW.id, NEW.document)
        ON CONFLICT (id) DO UPDATE SET document = excluded.document;
    INSERT INTO plans VALUES (NEW.id, length(NEW.document), NEW.made, NEW.made)
        ON CONFLICT (id) DO UPDATE SET
            bytes = excluded.bytes, made = excluded.made, used = excluded.used;
    DELETE FROM jobs WHERE id = NEW.id;
END;
CREATE TRIGGER forget AFTER DELETE ON plans BEGIN
    DELETE FROM documents WHERE id = OLD.id;
END;
PRAGMA user_version = {VERSION};
COMMIT;
"""
# Newer than the first version of the file: an older service leaves them alone.
ADDED = """
CREATE TABLE IF NOT EXISTS scenes (
    name TEXT PRIMARY KEY, bytes INTEGER NOT NULL, used REAL NOT NULL, document BLOB NOT NULL,
    info BLOB NOT NULL
);
CREATE TABLE IF NOT EXISTS attempts (id TEXT PRIMARY KEY, begun INTEGER NOT NULL);
CREATE TRIGGER IF NOT EXISTS forget_attempts AFTER DELETE ON jobs BEGIN
    DELETE FROM attempts WHERE id = OLD.id;
END;
CREATE TRIGGER IF NOT EXISTS failed AFTER UPDATE OF problem ON jobs BEGIN
    DELETE FROM attempts WHERE id = NEW.id;
END;
"""
"""Tables and triggers that a file of the same version may lack. Attempts are apart from their jobs:
SQLite would rewrite the documents of a job with its row."""
