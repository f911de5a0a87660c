"""Whether a configuration, or a motion between two, is free of contact: the planner's own check."""
