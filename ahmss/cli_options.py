"""What may be said to several commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["Json", "Keys", "Port", "Server", "Workspace"]

Server = Annotated[str, typer.Option("--server", metavar="HOST[:PORT]", help="The server; left out: this machine's.")]
Keys = Annotated[Path | None, typer.Option("--keys", metavar="DIR", help="Keys for a server on another machine.")]
Workspace = Annotated[
    Path | None, typer.Option("--workspace", metavar="DIR", help="The folder with objectdb/; left out: found.")
]
Port = Annotated[
    str, typer.Option("--port", metavar="[HOST:]PORT", help="Let human models in here, as at 7427; left out: nowhere.")
]
Json = Annotated[bool, typer.Option("--json", help="One JSON object on standard output.")]
