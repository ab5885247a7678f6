"""`ahmss motion`: clips changed, brought in and given out; each function is one command that writes one file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import msgspec

from ahmss.errors import CommandError, DataError
from ahmss.main.clipviews import in_frames
from ahmss.main.motionfiles import body_named, the_motion_in
from ahmss.motion.annotation import annotate, load_table
from ahmss.motion.clip import Clip, load, save
from ahmss.motion.edit import at_rate, begun_at_origin, cut, mirrored
from ahmss.motion.exporting import export
from ahmss.motion.importance import derive
from ahmss.motion.importing import import_clip
from ahmss.motion.resample import resample
from ahmss.motion.transfer import transfer

__all__ = [
    "Output",
    "annotate_file",
    "cut_file",
    "derive_file",
    "export_file",
    "import_file",
    "mirror_file",
    "resample_file",
    "retarget_file",
]

_MOST_FRAMES = 1_000_000


class Output(msgspec.Struct, frozen=True):
    """Where a command writes. path: left out, a name made from the source's; force: over what is there."""

    path: Path | None = None
    force: bool = False

    def beside(self, source: Path, tag: str) -> Path:
        """The file to write: the one asked for, or one in the current folder named after the source and a tag.

        Raises:
            CommandError: it is there already.
        """
        path = self.path or Path(f"{source.stem}_{tag}.npz")
        if path.exists() and not self.force:
            own = "this is the file itself" if source.exists() and path.samefile(source) else "it is there already"
            raise CommandError(f"{path}: {own}; name another with -o, or say --force to write over it")
        return path


def cut_file(path: Path, begin: float, end: float | None, output: Output) -> None:
    """Write the part of a clip from one second to another, both with.

    Raises:
        CommandError: the clip does not go that far.
    """
    clip = load(path)
    until = clip.duration if end is None else end
    if clip.header.times is None and not 0.0 <= begin <= until < clip.duration + 0.5 / clip.rate:
        asked = f"seconds {begin:g} to {until:g}"
        raise CommandError(f"{path}: {asked} are not in the clip, which goes from 0 to {clip.duration:g}")
    first, last = round(begin * clip.rate), round(until * clip.rate)
    _changed(path, output.beside(path, "cut"), lambda: cut(clip, first, last))


def mirror_file(path: Path, output: Output) -> None:
    """Write a clip as a mirror shows it."""
    clip = load(path)
    _changed(path, output.beside(path, "mirrored"), lambda: mirrored(clip))


def resample_file(path: Path, frames: int | None, seconds: float | None, rate: float | None, output: Output) -> None:
    """Write a clip in another number of frames, of another duration, or at another rate.

    Raises:
        CommandError: none of the three is asked for, several are, or what is asked for is no length of a motion.
    """
    clip = load(path)
    if [frames, seconds, rate].count(None) != 2:
        raise CommandError("say one of --frames, --seconds and --rate")
    for name, asked, most in (("frames", frames, _MOST_FRAMES), ("seconds", seconds, 3600.0), ("rate", rate, 1000.0)):
        if asked is not None and not 0 < asked <= most:
            raise CommandError(f"--{name} {asked:g}; give more than 0 and at most {most:g}")
    if rate is not None:
        _changed(path, output.beside(path, "resampled"), lambda: at_rate(clip, rate))
        return
    count = frames if frames is not None else round((seconds or 0.0) * clip.rate) + 1
    _changed(path, output.beside(path, "resampled"), lambda: resample(clip, count))


def retarget_file(path: Path, body: str, performer: str, workspace: Path | None, output: Output) -> None:
    """Write a clip for another human of humandb.

    Raises:
        CommandError: the clip does not say for whom it was made, and neither does the command.
    """
    clip = load(path)
    made_for = performer or clip.header.human
    if not made_for:
        raise CommandError(f"{path}: the clip does not say whose it is; name the body that it was made for with --from")
    from_skeleton, (skeleton, _) = body_named(made_for, workspace)[0], body_named(body, workspace)
    _changed(path, output.beside(path, body), lambda: transfer(clip, from_skeleton, skeleton))


def derive_file(path: Path, body: str, workspace: Path | None, output: Output) -> None:
    """Write a clip with the importance that its motion has."""
    held = the_motion_in(path, "", "", workspace)
    skeleton = body_named(body, workspace)[0] if body else held.skeleton
    _changed(path, output.beside(path, "weighed"), lambda: derive(held.clip, skeleton))


def annotate_file(path: Path, table: Path, body: str, workspace: Path | None, output: Output) -> None:
    """Write a clip with what a table written by hand says of it."""
    held = the_motion_in(path, "", "", workspace)
    skeleton = body_named(body, workspace)[0] if body else held.skeleton
    rows = load_table(table)
    _changed(path, output.beside(path, "annotated"), lambda: annotate(held.clip, rows, skeleton))


def import_file(
    path: Path, body: str, rate: float | None, unit: str | None, workspace: Path | None, output: Output
) -> None:
    """Write a clip of another maker's file, performed by a human of humandb, and say what was found and done."""
    target = output.beside(path, body)
    clip, said = import_clip(path, body_named(body, workspace)[0], rate=rate, unit=unit)
    for sentence in said:
        print(f"{path.name}: {sentence}")
    _write(clip, target)


def export_file(path: Path, output: Output, human: str, body: str, workspace: Path | None) -> None:
    """Write a motion for other programs, by the ending of the output's name.

    Raises:
        CommandError: no output is named.
    """
    if output.path is None:
        raise CommandError("name the file to write with -o; its ending chooses BVH, GLB or clip: -o walk.glb")
    target = output.beside(path, "")
    held = the_motion_in(path, human, body, workspace)
    clip = begun_at_origin(held.clip) if target.suffix.lower() == ".npz" else in_frames(path, held.clip)
    export(target, clip, held.skeleton, held.look)
    print(f"wrote {target}: {clip.frames} frames of {held.skeleton.name}")


def _changed(source: Path, target: Path, change: Callable[[], Clip]) -> None:
    """Write what a change makes of a clip; that it can't be done is an error of the file."""
    try:
        clip = change()
    except ValueError as error:
        raise CommandError(f"{source}: {error}") from error
    _write(clip, target)


def _write(clip: Clip, target: Path) -> None:
    if target.suffix.lower() != ".npz":
        raise CommandError(f"{target}: a clip's file ends in .npz; `ahmss motion export` writes other formats")
    try:
        save(clip, target)
    except OSError as error:
        raise DataError(target, "", f"can't be written ({error.strerror})") from error
    print(f"wrote {target}: {clip.frames} frames, {clip.duration:.2f} s")
