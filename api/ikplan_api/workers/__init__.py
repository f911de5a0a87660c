"""Planning in worker processes: the planner, its workers and their tasks."""
