"""Convex pieces of the links of robots, made from the meshes of installed packages."""
