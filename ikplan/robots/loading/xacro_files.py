"""xacro files become URDFs here, without ROS.

xacro evaluates Python expressions of the file: this is for files that their user trusts, in Python
and in the shell, and never for the service. It is installed with ``pip install ikplan[xacro]``.
"""

from __future__ import annotations

import contextlib
import io
import re
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ikplan.errors import InvalidRobot, near_names
from ikplan.robots.loading.packages import find_package

__all__ = ["expand_xacro", "is_xacro"]

_ARGUMENT = re.compile(r"<xacro:arg\s[^>]*?\bname\s*=\s*[\"']([^\"']+)[\"'][^>]*>")
_DEFAULT = re.compile(r"\bdefault\s*=\s*(?:\"([^\"]*)\"|'([^']*)')")
_ROOT = re.compile(r"<robot\b[^>]*>")
_USED = re.compile(r"\$\(arg\s+([^)\s]+)\s*\)")
_ONE_AT_A_TIME = threading.Lock()
"""xacro keeps what it reads in variables of its modules."""


def is_xacro(file: Path, document: bytes) -> bool:
    """Whether a file is for xacro: by its suffix, or by macros in it."""
    return file.suffix.lower() == ".xacro" or re.search(rb"<xacro:\w", document) is not None


def expand_xacro(file: Path, arguments: Mapping[str, str]) -> bytes:
    """Expand a xacro file to a URDF.

    Args:
        file: The file; ``$(find package)`` is looked up around it.
        arguments: Values of its arguments, by name.

    Raises:
        InvalidRobot: xacro is not installed, an argument is missing or not one of the file's, a
            package or file is missing, or xacro refuses the file.
    """
    try:
        import xacro
    except ImportError as error:
        raise InvalidRobot(
            f"{file}: a xacro file needs xacro: pip install 'ikplan[xacro]'", robot=str(file)
        ) from error
    with _ONE_AT_A_TIME, _packages_of(file), contextlib.redirect_stderr(io.StringIO()):
        try:
            text = file.read_text()
            mappings = {**_needed_early(text), **arguments}
            xacro.all_includes.clear()
            document = xacro.process_file(str(file), mappings=mappings)
            expanded: bytes = document.documentElement.toxml().encode()
        except Exception as error:  # expressions of the file raise what they like
            raise _refused(file, error) from error
        files = [file, *(Path(name) for name in xacro.all_includes)]
    _check_known(file, arguments, files)
    return expanded


def _needed_early(text: str) -> dict[str, str]:
    """Defaults of the arguments that the outermost element names before they are declared."""
    root = _ROOT.search(text)
    used = set(_USED.findall(root[0])) if root else set()
    found: dict[str, str] = {}
    for match in _ARGUMENT.finditer(text):
        default = _DEFAULT.search(match[0])
        if match[1] in used and default:
            found.setdefault(match[1], default[1] if default[1] is not None else default[2])
    return {name: value for name, value in found.items() if "$" not in value}


def _arguments(text: str) -> dict[str, bool]:
    """Arguments that a file declares or uses, each with whether it has a default there."""
    declared = dict.fromkeys((m[1] for m in _ARGUMENT.finditer(text)), True)
    return {**dict.fromkeys(_USED.findall(text), False), **declared}


def _check_known(file: Path, arguments: Mapping[str, str], files: list[Path]) -> None:
    """Refuse an argument that nothing uses: xacro would pass over it in silence."""
    declared: set[str] = set()
    for each in files:
        with contextlib.suppress(OSError):
            declared |= _arguments(each.read_text(errors="replace")).keys()
    for name in arguments:
        if name not in declared:
            near = near_names(name, declared)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InvalidRobot(
                f"{file}: no argument {name!r}{hint}; there are "
                f"{', '.join(sorted(declared)) or 'none'}",
                robot=str(file),
                value=name,
                valid=sorted(declared),
            )


def _refused(file: Path, error: Exception) -> InvalidRobot:
    """What xacro says, with what to do about it."""
    cause: BaseException | None = error
    while cause is not None:
        if isinstance(cause, InvalidRobot):
            return cause
        cause = getattr(cause, "exc", None) or cause.__cause__
    try:
        text = file.read_text(errors="replace")
    except OSError:
        text = ""
    reason = " ".join(f"{error}".split()) or type(error).__name__
    hint = ""
    declared = _arguments(text)
    if "ndefined substitution argument" in reason:
        hint = "; give it as NAME:=VALUE"
        needed = [name for name, has_default in declared.items() if not has_default]
        if needed:
            hint += f" (without a default: {', '.join(needed)})"
    elif declared:
        hint = f"; arguments of the file: {', '.join(declared)}"
    return InvalidRobot(f"{file}: xacro: {reason}{hint}", robot=str(file), valid=list(declared))


@contextlib.contextmanager
def _packages_of(file: Path) -> Iterator[None]:
    """Let ``$(find package)`` look around a file, where xacro would ask ROS."""
    from xacro import substitution_args as substitution

    def find(package: str) -> str:
        return str(find_package(package, file))

    kept: tuple[Any, Any] = substitution._eval_find, substitution._eval_dict["find"]
    substitution._eval_find = substitution._eval_dict["find"] = find
    try:
        yield
    finally:
        substitution._eval_find, substitution._eval_dict["find"] = kept
