"""A PostgreSQL of our own, on a loopback port, which can be restarted."""

from __future__ import annotations

import contextlib
import os
import pwd
import shutil
import socket
import subprocess
import tempfile
import uuid
from collections.abc import Iterator
from pathlib import Path

import psycopg

WHY_NOT = "PostgreSQL's initdb is not installed"


def binaries() -> Path | None:
    """Where initdb is: on the path, or where Debian puts it."""
    if (found := shutil.which("initdb")) is not None:
        return Path(found).parent
    places = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"))
    return places[-1].parent if places else None


def _other_user() -> str | None:
    """PostgreSQL refuses to run as root."""
    if os.getuid() != 0:
        return None
    with contextlib.suppress(KeyError):
        return pwd.getpwnam("postgres").pw_name
    return "nobody"


def _free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as free:
        return int(free.getsockname()[1])


class Postgres:
    """A running server.

    Attributes:
        url: Address of a database.
    """

    def __init__(self, folder: Path, programs: Path) -> None:
        self._data = folder / "data"
        self._programs = programs
        self._folder = folder
        self._user = _other_user()
        self._port = _free_port()
        self.url = self.url_of("postgres")

    def url_of(self, database: str) -> str:
        """Return the address of a database."""
        return f"postgresql://ikplan@127.0.0.1:{self._port}/{database}"

    def _run(self, *command: str) -> None:
        program = str(self._programs / command[0])
        subprocess.run(
            [program, *command[1:]],
            user=self._user,
            cwd=self._folder,
            check=True,
            stdout=subprocess.DEVNULL,
            timeout=120,
        )

    def create(self) -> None:
        """Make the folder of the server, and start it."""
        options = ("--auth", "trust", "--username", "ikplan", "--no-sync", "--encoding", "UTF8")
        self._run("initdb", "--pgdata", str(self._data), *options)
        self.start()

    def start(self) -> None:
        """Start the server; return when it answers."""
        options = f"-p {self._port} -c listen_addresses=127.0.0.1 -c fsync=off "
        options += f"-c unix_socket_directories={self._folder}"
        log = str(self._folder / "log")
        self._run("pg_ctl", "-D", str(self._data), "-o", options, "-l", log, "-w", "start")

    def stop(self, how: str = "fast") -> None:
        """Stop the server: ``"fast"``, or ``"immediate"`` as a crash would."""
        self._run("pg_ctl", "-D", str(self._data), "-m", how, "-w", "stop")

    def new_database(self) -> str:
        """Make an empty database; return its address."""
        name = f"t{uuid.uuid4().hex[:12]}"
        with psycopg.connect(self.url, autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}".encode())
        return self.url_of(name)


@contextlib.contextmanager
def postgres() -> Iterator[Postgres]:
    """Run a server in a folder of its own, and remove both."""
    programs = binaries()
    assert programs is not None, WHY_NOT
    folder = Path(tempfile.mkdtemp(prefix="ikplan-postgres-"))
    try:
        server = Postgres(folder, programs)
        if server._user is not None:
            shutil.chown(folder, server._user)
        server.create()
        try:
            yield server
        finally:
            with contextlib.suppress(subprocess.CalledProcessError):
                server.stop("immediate")
    finally:
        shutil.rmtree(folder, ignore_errors=True)
