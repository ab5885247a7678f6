"""Keys for servers that other machines can reach (CURVE): made, kept and read in one directory.

    keys/server.key         the server's pair: only on the server's machine, mode 0600
    keys/server.pub         the server's public key: copy it to every client
    keys/client.key         a client's pair: only on that client's machine, mode 0600
    keys/authorised/NAME    public keys of the clients that the server lets in
    keys/NAME/              the same for a further client: its client.key and server.pub, to be taken to its machine

A file holds `public = KEY`, and in a `.key` also `secret = KEY`, as the 40 characters of ZeroMQ's Z85.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import zmq

from ahmss.errors import DependencyError, WorldError

__all__ = ["ClientKeys", "ServerKeys", "authorise", "make", "read_client", "read_server", "require_curve"]

_KEY_LENGTH = 40


@dataclass(frozen=True)
class ClientKeys:
    """One client's pair and the public key of the server that it expects."""

    public: bytes
    secret: bytes
    server: bytes

    def secure(self, socket: zmq.Socket[bytes]) -> None:
        """Encrypt the socket's connections, before it connects."""
        require_curve()
        socket.curve_publickey = self.public
        socket.curve_secretkey = self.secret
        socket.curve_serverkey = self.server


@dataclass(frozen=True)
class ServerKeys:
    """The server's pair and the public keys that it lets in."""

    public: bytes
    secret: bytes
    authorised: frozenset[bytes]

    def secure(self, socket: zmq.Socket[bytes]) -> None:
        """Encrypt the socket's connections and ask each for its key, before it binds."""
        require_curve()
        socket.curve_publickey = self.public
        socket.curve_secretkey = self.secret
        socket.curve_server = True
        socket.zap_domain = b"ahmss"


def require_curve() -> None:
    """DependencyError where the ZeroMQ library was built without CURVE."""
    if not zmq.has("curve"):
        raise DependencyError(
            "this machine's ZeroMQ library has no CURVE encryption, so no other machine may connect; "
            "install pyzmq from its wheel: pip install --force-reinstall pyzmq"
        )


def make(directory: Path, name: str = "client") -> list[Path]:
    """Make what is missing of a server's and a client's pair, and authorise the client; returns the files made.

    The first client's pair stays in the directory; each further name gets one in a directory of its own.
    """
    require_curve()
    _check_name(name)
    (directory / "authorised").mkdir(parents=True, exist_ok=True)
    directory.chmod(0o700)
    made: list[Path] = []
    if not (directory / "server.key").exists():
        public, secret = zmq.curve_keypair()
        made += [_write(directory / "server.key", public, secret), _write(directory / "server.pub", public)]
    if not (directory / "authorised" / name).exists():
        first = not (directory / "client.key").exists()
        own = directory if first else directory / name
        own.mkdir(mode=0o700, exist_ok=True)
        public, secret = zmq.curve_keypair()
        made += [_write(own / "client.key", public, secret), authorise(directory, name, public)]
        if not first:
            made.append(_write(own / "server.pub", _read(directory / "server.pub")["public"]))
    return made


def authorise(directory: Path, name: str, public: bytes) -> Path:
    """Let the client with this public key in, from the server's next start on."""
    _check_name(name)
    (directory / "authorised").mkdir(parents=True, exist_ok=True)
    return _write(directory / "authorised" / name, public)


def _check_name(name: str) -> None:
    """WorldError for what is no name of a client: it names files."""
    if not name.replace("-", "").replace("_", "").isalnum() or name in ("authorised", "server", "client.key"):
        raise WorldError(f'"{name}" is no name for a client: use letters, digits, - and _')


def read_server(directory: Path) -> ServerKeys:
    """The server's keys; WorldError where they are missing, damaged or open to others."""
    pair = _read(directory / "server.key")
    allowed = [_read(path)["public"] for path in sorted((directory / "authorised").glob("*"))]
    return ServerKeys(pair["public"], _secret(directory / "server.key", pair), frozenset(allowed))


def read_client(directory: Path) -> ClientKeys:
    """A client's keys; WorldError where they are missing, damaged or open to others."""
    pair = _read(directory / "client.key")
    server = _read(directory / "server.pub")["public"]
    return ClientKeys(pair["public"], _secret(directory / "client.key", pair), server)


def _write(path: Path, public: bytes, secret: bytes | None = None) -> Path:
    """Write a key file; one with a secret can never be read by others, not even for a moment."""
    text = f"public = {public.decode()}\n" + (f"secret = {secret.decode()}\n" if secret else "")
    path.unlink(missing_ok=True)
    with os.fdopen(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
        file.write(text)
    return path


def _read(path: Path) -> dict[str, bytes]:
    """The entries of a key file."""
    try:
        lines = path.read_text("ascii").splitlines()
    except FileNotFoundError as error:
        raise WorldError(
            f"{path}: no such key; make it with `ahmss keys` (server.pub comes from the server)"
        ) from error
    except (OSError, UnicodeDecodeError) as error:
        raise WorldError(f"{path}: this key can't be read ({error}); make a new one with `ahmss keys`") from error
    entries = {key.strip(): value.strip().encode() for key, _, value in (line.partition("=") for line in lines if line)}
    if any(len(value) != _KEY_LENGTH for value in entries.values()) or "public" not in entries:
        raise WorldError(f"{path}: no key file (`public = ` and 40 characters); make a new one with `ahmss keys`")
    return entries


def _secret(path: Path, pair: dict[str, bytes]) -> bytes:
    if path.stat().st_mode & 0o077:
        raise WorldError(f"{path}: others can read this secret key; close it with `chmod 600 {path}`")
    if "secret" not in pair:
        raise WorldError(f"{path}: there is no secret in it; make a new one with `ahmss keys`")
    return pair["secret"]
