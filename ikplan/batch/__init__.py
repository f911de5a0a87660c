"""Many requests: streamed in, answered by worker processes, written so that a batch can resume."""
