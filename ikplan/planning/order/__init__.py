"""Free order: which task of a path comes next, and in which branch of the arm."""
