"""Storage of plans, jobs and uploaded robots: in memory, or in a SQLite file."""
