"""A clip written for other programs, in the format that the file's name ends in."""

from __future__ import annotations

from pathlib import Path

from ahmss.body.skeleton import Skeleton
from ahmss.errors import CommandError, DataError, ProtocolError
from ahmss.motion.bvh_out import write_bvh
from ahmss.motion.clip import Clip, save
from ahmss.motion.gltf import Look, animated

__all__ = ["ENDINGS", "export"]

ENDINGS = (".bvh", ".glb", ".npz")


def export(path: Path, clip: Clip, skeleton: Skeleton, look: Look | None) -> None:
    """Write a clip as BVH, as GLB with skin and animation, or as a clip.

    Args:
        path: the file; its ending chooses.
        clip: frames at even times.
        skeleton: the human whose motion it is.
        look: what that human looks like; only GLB needs it.

    Raises:
        CommandError: another ending, or a GLB of a human without a shape.
        DataError: the human's shape can't be read, or the file can't be written.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise CommandError(f'{path}: "{ending}" can\'t be written; name a file that ends in {", ".join(ENDINGS)}')
    if ending == ".glb" and look is None:
        raise CommandError(f"{path}: a GLB needs a human's shape; name one of humandb with --body")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        if ending == ".npz":
            save(clip, path)
        elif ending == ".bvh":
            write_bvh(path, skeleton, clip.rotations, clip.root, clip.rate)
        elif look is not None:
            path.write_bytes(animated(look, skeleton, (clip.rotations, clip.root, clip.rate), path.stem))
    except ProtocolError as error:
        raise DataError(path, "", f"the shape of {skeleton.name} can't be used: {error}") from error
    except OSError as error:
        raise DataError(path, "", f"can't be written ({error.strerror})") from error
