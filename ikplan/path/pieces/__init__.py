"""The smooth pieces of a tool path, and how the tool turns along them."""
