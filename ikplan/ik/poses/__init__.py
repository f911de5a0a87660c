"""Many poses of one arm at a time."""
