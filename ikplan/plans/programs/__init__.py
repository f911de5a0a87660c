"""Programs of few points: a plan thinned, and certified as its controller interpolates."""
