"""Path tracking: a continuous joint motion along a tool path."""
