"""The path asked for: poses, segments, and what must hold along them."""

from ikplan.path.rotation import rotation_of
from ikplan.path.support import refuse_unsupported
from ikplan.path.targets import targets_of

__all__ = ["refuse_unsupported", "rotation_of", "targets_of"]
