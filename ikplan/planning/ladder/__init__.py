"""The ladder graph of IK solutions, the shortest paths through it, and their shortening."""
