"""Which corners of a tool path are faster to stop at than to pass rounded."""
