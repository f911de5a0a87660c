"""The stages in the order they run: plans, timings, poses, warm-up and ids."""
