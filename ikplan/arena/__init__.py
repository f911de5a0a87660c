"""The arena: searches, the project's own and others, on the same targets with the same budget."""
