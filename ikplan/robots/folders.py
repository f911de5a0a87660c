"""Where robots are found: our own folder, the user's folders, and the URDFs of a package."""

from __future__ import annotations

import functools
import os
import site
import sys
from pathlib import Path

from ikplan.errors import InvalidRobot, RobotNotFound

__all__ = [
    "PATH_VARIABLE",
    "catalogue_folders",
    "package_file",
    "package_places",
    "robot_folder",
    "robot_folders",
    "robot_names",
    "searched_folders",
    "user_folder",
]

PATH_VARIABLE = "IKPLAN_ROBOTS_PATH"
_FILE = "robot.yaml"
_HERE = Path(__file__).resolve().parent
_EXAMPLE_DATA = Path("share/example-robot-data/robots")


def catalogue_folders() -> list[Path]:
    """The folders that hold robots: those of ``IKPLAN_ROBOTS_PATH``, the user's own, then ours.

    A robot of the user's folders hides one of the same name behind it, as on any search path.

    Raises:
        InvalidRobot: The variable names something that is not a folder.
    """
    return [Path(folder) for folder in searched_folders()]


def searched_folders() -> tuple[str, ...]:
    """The same folders, as text; same errors."""
    folders = []
    for part in os.environ.get(PATH_VARIABLE, "").split(os.pathsep):
        if not part:
            continue
        if not os.path.isdir(part):
            raise InvalidRobot(f"{PATH_VARIABLE} names {part!r}, which is not a folder", value=part)
        folders.append(str(Path(part)))
    if (own := _own_folder()) not in folders and os.path.isdir(own):
        folders.append(own)
    return (*folders, _our_folder())


@functools.cache
def _our_folder() -> str:
    installed, checkout = _HERE / "catalogue", _HERE.parents[1] / "robots"
    return str(installed if installed.is_dir() else checkout)


def user_folder() -> Path:
    """The folder that new robots are written to; it need not exist.

    The first of ``IKPLAN_ROBOTS_PATH``, or else ``ikplan/robots`` where the user's settings are
    (``XDG_CONFIG_HOME``, ``~/.config``).
    """
    for part in os.environ.get(PATH_VARIABLE, "").split(os.pathsep):
        if part:
            return Path(part)
    return Path(_own_folder())


def _own_folder() -> str:
    settings = os.environ.get("XDG_CONFIG_HOME") or "~/.config"
    return os.path.join(os.path.expanduser(settings), "ikplan", "robots")


def robot_names() -> list[str]:
    """Names of the catalogue, sorted."""
    return list(robot_folders())


def robot_folders() -> dict[str, Path]:
    """Folders of the robots of the catalogue, by name, sorted; errors of catalogue_folders."""
    found: dict[str, Path] = {}
    for folder in catalogue_folders():
        for entry in folder.iterdir():
            if entry.name not in found and (entry / _FILE).is_file():
                found[entry.name] = entry
    return dict(sorted(found.items()))


def robot_folder(name: str) -> Path:
    """Folder of a robot of the catalogue.

    Raises:
        RobotNotFound: No such name; names that look like it are offered.
    """
    for folder in catalogue_folders():
        # Compared with the listing before it is joined to a path, so that no name leads elsewhere.
        if name in os.listdir(folder) and (folder / name / _FILE).is_file():
            return folder / name
    raise RobotNotFound(name=name, valid=robot_names())


def package_file(package: str, path: str) -> Path:
    """A file of the example-robot-data package, wherever it is installed.

    Args:
        package: Name of the distribution.
        path: Path below its ``robots`` folder.

    Raises:
        InvalidRobot: The package or the file is not installed; the places tried are listed.
    """
    places = package_places(package, path)
    if places[-1].is_file():
        return places[-1]
    roots = _package_roots(package, tuple(sys.path))
    tried = ", ".join(str(root) for root in roots)
    raise InvalidRobot(
        f"{path} of {package} is not installed (pip install {package}); looked in {tried}",
        value=path,
        valid=[str(root) for root in roots],
    )


def package_places(package: str, path: str) -> list[Path]:
    """Places where a file of a package may be, up to the first where it is.

    Args:
        package: Name of the distribution.
        path: Path below its ``robots`` folder.
    """
    places = []
    for root in _package_roots(package, tuple(sys.path)):
        places.append(root / path)
        if places[-1].is_file():
            break
    return places


@functools.lru_cache(maxsize=8)
def _package_roots(package: str, search_path: tuple[str, ...]) -> list[Path]:
    """Places where the package's data may be: its own record first, then the usual prefixes."""
    import importlib.metadata  # half of what listing the robots would take

    roots: list[Path] = []
    try:
        distribution = importlib.metadata.distribution(package)
        roots.append(Path(str(distribution.locate_file("cmeel.prefix"))) / _EXAMPLE_DATA)
    except importlib.metadata.PackageNotFoundError:
        pass
    places = [*site.getsitepackages(), site.getusersitepackages(), *search_path]
    roots += [Path(place) / "cmeel.prefix" / _EXAMPLE_DATA for place in places if place]
    roots.append(Path(sys.prefix) / _EXAMPLE_DATA)
    return list(dict.fromkeys(roots))
