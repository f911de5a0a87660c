"""The garbage collector in a command.

Modules are no garbage; looking for some among them takes a tenth of a short command's time, and as
much again when the process ends. So a command starts without the collector and ends with nothing
for it to look through; a command that may take long has it from the moment when it is loaded.
"""

from __future__ import annotations

import gc

__all__ = ["end", "loaded", "start"]


def start() -> None:
    """Collect nothing while a command is loaded."""
    gc.disable()


def loaded() -> None:
    """Collect from now on, but not among what is loaded; nothing is done where it is on already."""
    if not gc.isenabled():
        gc.freeze()
        gc.enable()


def end() -> None:
    """Leave everything to the end of the process."""
    gc.freeze()
