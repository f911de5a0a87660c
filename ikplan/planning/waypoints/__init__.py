"""One configuration for each of some waypoints, far apart from one another."""
