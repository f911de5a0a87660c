"""Remove from the environment all that serving does not need, and tell how much went."""

import filecmp
import shutil
import subprocess
import sys
import sysconfig
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import yaml

from ikplan.robots import catalogue_visual, robot_names
from ikplan.robots.folders import package_file, robot_folder

SITE = Path(sysconfig.get_path("purelib"))
PREFIX = SITE / "cmeel.prefix"


def main() -> None:
    """Remove, kind by kind."""
    before = size(SITE)
    for kind, removed in (
        ("robots that are not in the catalogue", slim_robots()),
        ("headers, build files, static libraries", remove(build_files())),
        ("test suites of the libraries", remove(test_suites())),
        ("copies of the same library", link_copies()),
        ("pip", remove_pip()),
    ):
        print(f"{removed / 1e6:7.1f} MB: {kind}")
    print(f"{before / 1e6:.0f} MB -> {size(SITE) / 1e6:.0f} MB")


def size(folder: Path) -> int:
    """Bytes of all files below, links not followed."""
    return sum(p.lstat().st_size for p in folder.rglob("*") if not p.is_dir() or p.is_symlink())


def remove(folders: Iterator[Path]) -> int:
    """Remove files and folders; returns their bytes."""
    before = size(SITE)
    for path in list(folders):
        if path.is_dir():
            shutil.rmtree(path)
        else:
            path.unlink(missing_ok=True)
    return before - size(SITE)


def slim_robots() -> int:
    """Keep of example-robot-data the catalogue's URDFs, the meshes that are drawn, and licences."""
    keep = set()
    for name in robot_names():
        document = yaml.safe_load((robot_folder(name) / "robot.yaml").read_text())
        urdf = document["kinematics"].get("urdf")
        if urdf and urdf.get("package"):
            keep.add((package_file(urdf["package"], urdf["path"]), urdf["path"]))
        meshes = catalogue_visual(name, address=str).meshes
        keep |= {(file, path) for path, file in meshes.items()}
    (root,) = {file.parents[len(Path(path).parts) - 1] for file, path in keep}
    for folder in {Path(path).parts[0] for _, path in keep}:
        licences = (root / folder / name for name in ("LICENSE", "README.md"))
        keep |= {(file, f"{folder}/{file.name}") for file in licences if file.is_file()}
    kept = {path: file.read_bytes() for file, path in keep}
    removed = remove(iter([root]))
    for path, content in sorted(kept.items()):
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(content)
    total = sum(map(len, kept.values()))
    print(f"{total / 1e6:7.1f} MB kept: {len(kept)} files of the catalogue's robots")
    return removed - total


def build_files() -> Iterator[Path]:
    """What only compilers and linkers read."""
    yield PREFIX / "include"
    yield from PREFIX.rglob("cmake")
    yield from PREFIX.rglob("pkgconfig")
    yield from PREFIX.rglob("*.a")


def test_suites() -> Iterator[Path]:
    """Folders of tests within packages."""
    for name in ("tests", "test"):
        yield from (p for p in SITE.rglob(name) if p.is_dir() and (p / "__init__.py").is_file())


def link_copies() -> int:
    """Make libraries that a wheel holds under several names one file with links to it."""
    before = size(SITE)
    by_size = defaultdict(list)
    for path in sorted(PREFIX.glob("lib/*.so*")):
        if not path.is_symlink():
            by_size[path.stat().st_size].append(path)
    for paths in by_size.values():
        first = max(paths, key=lambda path: (len(path.name), path.name))
        for path in paths:
            if path != first and filecmp.cmp(first, path, shallow=False):
                path.unlink()
                path.symlink_to(first.name)
    return before - size(SITE)


def remove_pip() -> int:
    """Nothing is installed from here on."""
    before = size(SITE)
    subprocess.run(
        [sys.executable, "-m", "pip", "uninstall", "--yes", "--quiet", "pip"], check=True
    )
    return before - size(SITE)


if __name__ == "__main__":
    main()
