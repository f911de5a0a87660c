"""Random requests over every robot: whatever is asked, a certified plan or a typed refusal."""
