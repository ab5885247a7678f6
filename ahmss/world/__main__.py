"""`python -m ahmss.world`: one server in a process of its own, which says where it listens as a line of JSON."""

from __future__ import annotations

import argparse
import json
import resource
import signal
import sys
from pathlib import Path

from ahmss.errors import AhmssError
from ahmss.world.address import parse
from ahmss.world.keys import read_server
from ahmss.world.lockstep import LockstepServer
from ahmss.world.realtime import RealTimeServer
from ahmss.world.server import Settings

__all__ = ["main"]


def main(arguments: list[str] | None = None) -> int:
    """Serve until SIGTERM, SIGINT."""
    parser = argparse.ArgumentParser(prog="python -m ahmss.world", description=__doc__)
    parser.add_argument(
        "--address",
        default="",
        help="HOST:PORT; snapshots are on the port after it; port 0 lets the system choose both",
    )
    parser.add_argument("--rate", type=float, default=60.0, help="ticks a second")
    parser.add_argument("--lockstep", default="", help="names of the humans to wait for, with commas between")
    parser.add_argument("--directory", type=Path, help="where the world stays over a restart")
    parser.add_argument("--record", type=Path, help="a file that every tick is written to")
    parser.add_argument("--keys", type=Path, help="directory of keys (`ahmss keys`)")
    parser.add_argument("--lease", type=float, default=3.0, help="seconds until a silent main is gone")
    parser.add_argument("--grace", type=float, default=10.0, help="seconds until its human leaves")
    given = parser.parse_args(arguments)
    try:
        settings = Settings(
            parse(given.address), given.rate, tuple(filter(None, given.lockstep.split(","))), given.directory,
            given.record, read_server(given.keys) if given.keys else None, given.lease, given.grace,
        )  # fmt: skip
        kind = LockstepServer if settings.lockstep else RealTimeServer
        server = kind(settings, lambda line: print(line, file=sys.stderr, flush=True))
    except AhmssError as error:
        print(error, file=sys.stderr)
        return 1
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))  # a connection is a file; the usual 1024 are few
    for number in (signal.SIGTERM, signal.SIGINT):
        signal.signal(number, lambda *_: server.stop())
    print(json.dumps({"address": str(server.sockets.address)}), flush=True)
    try:
        server.run()
    finally:
        server.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
