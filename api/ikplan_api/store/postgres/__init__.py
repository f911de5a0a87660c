"""Plans, jobs, robots and scenes in PostgreSQL, for several replicas of the service."""
