"""Spoilt files of every kind end in one sentence, never in a traceback."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
import trimesh

from ahmss.database import Workspace
from ahmss.errors import AhmssError

from .conftest import add_object

CHECKOUT = Path(__file__).resolve().parents[2]


def spoil(data: bytes, rng: random.Random) -> bytes:
    """Some bytes changed, a piece cut out, doubled or moved."""
    out = bytearray(data)
    for _ in range(rng.randint(1, 8)):
        at, length = rng.randrange(len(out)), rng.randint(1, 40)
        what = rng.randrange(4)
        if what == 0:
            out[at] = rng.randrange(256)
        elif what == 1 and len(out) > 2 * length:
            del out[at : at + length]
        elif what == 2:
            out[at:at] = out[at : at + length]
        else:
            out[at : at + 4] = rng.choice([b"1e40", b"nan\n", b"-1\n\n", b"\xff\xff\xff\x7f", b"9999"])
    return bytes(out)


def look(workspace: Workspace) -> None:
    """Everything that reads the kind `thing`."""
    try:
        workspace.objects.get("thing")
        workspace.objects.place("thing", "thing")
        workspace.objects.shape("thing")
    except AhmssError as error:
        assert "\n" not in str(error)  # noqa: PT017 - either it is read, or it is told in a sentence


def fuzz(workspace: Workspace, seed: int, rounds: int) -> None:
    rng = random.Random(seed)
    text = (CHECKOUT / "objectdb/door/object.toml").read_bytes().replace(b'name = "door"', b'name = "thing"')
    dxf = (CHECKOUT / "objectdb/cup/cup.dxf").read_bytes()
    box = trimesh.creation.box((1.0, 2.0, 3.0))
    shapes = {s: box.export(file_type=s) for s in ("stl", "obj", "ply", "glb")}
    files = {"dxf": dxf} | {s: d if isinstance(d, bytes) else d.encode() for s, d in shapes.items()}
    for i in range(rounds):
        file = add_object(workspace, "thing", "")
        if i % 6 == 0:
            file.write_bytes(spoil(text, rng))
        else:
            suffix = ("dxf", "stl", "obj", "ply", "glb")[i % 5]
            (file.parent / f"t{i}.{suffix}").write_bytes(spoil(files[suffix], rng))
            file.write_text(f'shape = "t{i}.{suffix}"\nunit = "cm"\n')
        look(Workspace(workspace.root))


def test_spoilt_files_are_told(workspace: Workspace) -> None:
    fuzz(workspace, 1, 60)


@pytest.mark.long
@pytest.mark.timeout(900)
@pytest.mark.parametrize("seed", range(2, 6))
def test_many_spoilt_files_are_told(workspace: Workspace, seed: int) -> None:
    fuzz(workspace, seed, 1500)
