"""Many poses of one robot: from Python, and as a request."""
