"""Remove from example-robot-data all that no robot of the catalogue needs."""

import shutil
from pathlib import Path

import yaml

from ikplan.robots import catalogue_visual, robot_names
from ikplan.robots.folders import package_file, robot_folder


def main() -> None:
    """Keep the URDF files of the catalogue and the meshes that are drawn, and nothing beside."""
    keep = set()
    for name in robot_names():
        document = yaml.safe_load((robot_folder(name) / "robot.yaml").read_text())
        urdf = document["kinematics"].get("urdf")
        if urdf and urdf.get("package"):
            keep.add((package_file(urdf["package"], urdf["path"]), urdf["path"]))
        meshes = catalogue_visual(name, address=str).meshes
        keep |= {(file, path) for path, file in meshes.items()}
    (root,) = {file.parents[len(Path(path).parts) - 1] for file, path in keep}
    kept = {path: file.read_bytes() for file, path in keep}
    shutil.rmtree(root)
    for path, content in sorted(kept.items()):
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        (root / path).write_bytes(content)
    print(f"kept {len(kept)} files, {sum(map(len, kept.values())) / 1e6:.1f} MB")


if __name__ == "__main__":
    main()
