"""Request handlers that combine HTTP, jobs and robots; the routes call them."""
