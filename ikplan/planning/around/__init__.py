"""Around obstacles along a tool path, by self-motion and by what the path leaves free."""
