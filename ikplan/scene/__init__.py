"""What stands around an arm, and the shape of the arm itself: bodies of convex pieces."""
