"""From segments of a request to pieces of a tool path: targets, corners, blends, lead-ins."""
