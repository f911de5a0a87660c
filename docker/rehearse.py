"""Follow the Dockerfile without a container engine: each stage a folder, each step in a chroot.

For root on Linux; see README.md. It knows the instructions that the Dockerfile uses, no more.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
import time
from dataclasses import dataclass, field, replace
from pathlib import Path

CHECKOUT = Path(__file__).resolve().parents[1]
PROXIES = ("http_proxy", "https_proxy", "no_proxy", "NODE_EXTRA_CA_CERTS")
"""What a step may know of this machine: how its registries are reached."""
PATH = "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin"


@dataclass
class Stage:
    """What is known of a stage: its folder, and what the instructions set."""

    root: Path
    env: dict[str, str] = field(default_factory=lambda: {"PATH": PATH})
    folder: str = "/"
    user: str = "0:0"
    command: list[str] = field(default_factory=list)
    health: list[str] = field(default_factory=list)


def instructions() -> list[tuple[str, str]]:
    """The Dockerfile's instructions, each on one line, without comments."""
    text = (CHECKOUT / "docker/Dockerfile").read_text()
    lines = re.sub(r"^#.*\n", "", text, flags=re.MULTILINE).replace("\\\n", "").splitlines()
    return [(line.split()[0], line.split(maxsplit=1)[1].strip()) for line in lines if line.strip()]


def build(place: Path, kept: list[str]) -> Stage:
    """Follow every stage; what ``place/debian`` holds stands for the Dockerfile's base image.

    Stages that are kept were made before; what they set still counts.
    """
    stages: dict[str, Stage] = {}
    stage = Stage(place / "debian")
    for word, rest in instructions():
        if word in ("COPY", "RUN") and stage.root.name in kept:
            continue
        began = time.monotonic()
        if word == "FROM":
            image, _, name = rest.partition(" AS ")
            name = name or "final"
            root = place / name
            source = stages.get(image, Stage(place / "debian"))
            if name not in kept:
                shutil.rmtree(root, ignore_errors=True)
                subprocess.run(["cp", "-a", source.root, root], check=True)
            stage = replace(source, root=root, env=dict(source.env))
            stages[name] = stage
        elif word == "COPY":
            copy(stage, stages, shlex.split(rest))
        elif word == "RUN":
            script = f"cd {stage.folder} && {rest}"
            known = {name: os.environ[name] for name in PROXIES if name in os.environ}
            enter(stage, ["env", "-i", *pairs(known | stage.env), "HOME=/root", "sh", "-c", script])
        elif word == "ENV":
            for pair in shlex.split(rest):
                name, _, value = pair.partition("=")
                stage.env[name] = value.replace("$PATH", stage.env["PATH"])
        elif word == "WORKDIR":
            stage.folder = rest
            inside(stage, rest).mkdir(parents=True, exist_ok=True)
        elif word == "USER":
            stage.user = rest
        elif word == "HEALTHCHECK":
            stage.health = json.loads(rest[rest.index("CMD") + 3 :])
        elif word == "CMD":
            stage.command = json.loads(rest)
        elif word not in ("LABEL", "ARG", "EXPOSE", "VOLUME"):
            raise SystemExit(f"unknown instruction {word}")
        print(f"[{time.monotonic() - began:6.1f} s] {word} {rest[:90]}", flush=True)
    return stage


def inside(stage: Stage, path: str) -> Path:
    """A path of the stage, seen from outside."""
    return stage.root / Path(stage.folder, path).relative_to("/")


def copy(stage: Stage, stages: dict[str, Stage], words: list[str]) -> None:
    """COPY: files as they are, of folders what is in them."""
    source = CHECKOUT
    if words[0].startswith("--from="):
        source = stages[words.pop(0).removeprefix("--from=")].root
    *paths, target = words
    into = inside(stage, target)
    for path in paths:
        if source != CHECKOUT:
            files = [source / path.lstrip("/")]
        else:  # what git does not ignore: the .dockerignore leaves out the same
            listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", path]
            done = subprocess.run(listed, cwd=CHECKOUT, check=True, stdout=subprocess.PIPE)
            files = [CHECKOUT / name for name in done.stdout.decode().split("\0") if name]
        whole = source / path.lstrip("/")
        for file in files:
            to = into / file.name if whole.is_file() else into / file.relative_to(whole)
            to.parent.mkdir(parents=True, exist_ok=True)
            subprocess.run(["cp", "-aT", file, to], check=True)


def pairs(env: dict[str, str]) -> list[str]:
    """An environment as words for env(1)."""
    return [f"{name}={value}" for name, value in env.items()]


def enter(stage: Stage, command: list[str]) -> None:
    """Run a step as root in the stage's folder, with /proc and /dev there."""
    mounts = (
        f"mount -t proc proc {stage.root}/proc && mount --rbind /dev {stage.root}/dev && "
        f'exec chroot {stage.root} "$@"'
    )
    subprocess.run(
        ["unshare", "--mount", "--pid", "--fork", "sh", "-c", mounts, "sh", *command], check=True
    )


CONFINED = """
set -e
root=$1 data=$2 user=$3; shift 3
ip link set lo up
mount --bind "$root" "$root"
mount -o remount,bind,ro,nosuid,nodev "$root"
mount -t proc -o nosuid,nodev,noexec proc "$root/proc"
mount -t tmpfs -o nosuid,mode=755,size=1m tmpfs "$root/dev"
for name in null zero full random urandom; do
    touch "$root/dev/$name"; mount --bind "/dev/$name" "$root/dev/$name"
done
mkdir "$root/dev/shm"
mount -o remount,ro "$root/dev"
mount -t tmpfs -o nosuid,nodev,noexec,size=64m tmpfs "$root/dev/shm"
mount -t tmpfs -o nosuid,nodev,noexec,size=64m tmpfs "$root/tmp"
mount --bind "$data" "$root/data"
mount -o remount,bind,rw,nosuid,nodev,noexec "$root/data"
exec chroot "$root" setpriv --reuid "${user%:*}" --regid "${user#*:}" --clear-groups \
    --no-new-privs --inh-caps=-all --bounding-set=-all -- env -i "$@"
"""


def confined(stage: Stage, data: Path, env: dict[str, str], command: list[str]) -> list[str]:
    """The command that runs another one as a container with every right taken away would.

    It is process 1, sees no network but its own loopback, and can write to /tmp, /dev/shm and
    /data alone.
    """
    words = [stage.root, data, stage.user, *pairs(stage.env | env), *command]
    spaces = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "--net", "--ipc", "--uts"]
    return [*spaces, "sh", "-c", CONFINED, "sh", *map(str, words)]


def main() -> None:
    """Build, or run a command in what was built."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("place", type=Path, help="folder with the Debian root `debian`")
    parser.add_argument("--keep", action="append", default=[], help="a stage made before")
    parser.add_argument("--run", nargs=argparse.REMAINDER, help="[NAME=VALUE ...] [COMMAND ...]")
    options = parser.parse_args()
    place = options.place.resolve()
    record = place / "final.json"
    if options.run is None:
        stage = build(place, options.keep)
        known = {**vars(stage), "root": str(stage.root)}
        record.write_text(json.dumps(known, indent=1))
        return
    stage = Stage(**json.loads(record.read_text()))
    data = place / "data"
    if not data.exists():  # a new volume begins as what the image has there
        shutil.copytree(Path(stage.root) / "data", data)
        shutil.copystat(Path(stage.root) / "data", data)
        os.chown(data, *map(int, stage.user.split(":")))
    env = {}
    words = options.run
    while words and re.fullmatch(r"[A-Z_]+=.*", words[0]):
        name, _, value = words.pop(0).partition("=")
        env[name] = value
    command = confined(stage, data, env, words or stage.command)
    os.execvp(command[0], command)


if __name__ == "__main__":
    sys.exit(main())
