"""The path asked for: poses, and what must hold at each."""

from ikplan.path.targets import rotation_of, targets_of

__all__ = ["rotation_of", "targets_of"]
