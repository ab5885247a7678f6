"""A server in a process of its own, clients, and the care that none is left behind."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from ahmss.world.client import WorldClient
from ahmss.world.process import ServerProcess


def children() -> set[int]:
    """Process ids of this process's children that have not been waited for."""
    return {int(pid) for path in Path("/proc/self/task").glob("*/children") for pid in path.read_text().split()}


def sockets() -> set[str]:
    """The sockets that this process has open."""
    links = set()
    for path in Path("/proc/self/fd").iterdir():
        try:
            links.add(os.readlink(path))
        except FileNotFoundError:  # the directory's own descriptor
            continue
    return {link for link in links if link.startswith("socket:")}


@pytest.fixture(autouse=True)
def _nothing_left_open() -> Iterator[None]:
    before = children(), sockets()
    yield
    assert children() <= before[0], "a test left a process behind"
    assert sockets() <= before[1], "a test left a socket open"


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[..., ServerProcess]]:
    """Starts servers; they are stopped after the test."""
    servers: list[ServerProcess] = []

    def begin(**options: object) -> ServerProcess:
        options.setdefault("log", tmp_path / "server.log")
        servers.append(ServerProcess(**options))  # type: ignore[arg-type]
        return servers[-1]

    yield begin
    for server in servers:
        server.stop()


@pytest.fixture
def connect() -> Iterator[Callable[..., WorldClient]]:
    """Makes clients; they are closed after the test."""
    clients: list[WorldClient] = []

    def begin(server: ServerProcess | str, **options: object) -> WorldClient:
        address = server if isinstance(server, str) else server.address
        options.setdefault("timeout", 20.0)
        clients.append(WorldClient(address, **options))  # type: ignore[arg-type]
        return clients[-1]

    yield begin
    for client in clients:
        client.close()
