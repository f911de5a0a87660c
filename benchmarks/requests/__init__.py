"""Random requests over every robot: whatever is asked, a certified plan or a typed refusal."""

import ikplan.workers.single_threaded  # noqa: F401 - before NumPy counts the processors
