"""Several replicas of the service on one PostgreSQL: ``python -m benchmarks.fleet``."""
