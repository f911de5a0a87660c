"""The version, which every plan's id holds."""

__all__ = ["__version__"]

__version__ = "0.1.0"
