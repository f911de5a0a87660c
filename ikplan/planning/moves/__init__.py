"""Free-space motion: from one configuration to another around what is in the way."""
