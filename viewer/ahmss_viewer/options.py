"""What a person asks of the viewer, and what it tells at the end."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from ahmss.errors import CommandError

__all__ = ["CAMERAS", "CUTS", "ViewOptions", "ViewReport"]

CUTS = "cuts"
CAMERAS = ("auto", CUTS, "front", "back", "left", "right", "top", "close")
_LARGEST = 4096


@dataclass(frozen=True)
class ViewOptions:
    """How to view a world.

    Attributes:
        address: of the server, `HOST` or `HOST:PORT`; "" is this machine.
        keys: the directory of this client's keys, for a server on another machine.
        replay: a recording to view in place of a server.
        headless: no window. Any of the three files below asks for it too.
        record: an MP4 of what is shown; of a recording, every frame at its rate.
        snapshot: one picture; of a recording at `at` seconds, else as soon as there is a human (or after 2 s).
        sheet: a page with every `every`-th frame (0: so many that some 24 fill it).
        every: frames of the world between two tiles of the sheet.
        size: width and height in pixels.
        request: ask and wait for each world in place of following what the server publishes.
        camera: one of CAMERAS, seen from the first human; "auto" finds a view that shows what happens,
            "cuts" one for each part of a recording, in files only.
        position, look_at: the camera's place, and what it looks at, metres; each may stand alone.
        follow: the name of a human to keep in the middle.
        eyes: the name of a human whose eyes are the camera; at `look_at`, or where its head faces. Not in a window.
        at: seconds from the recording's start, of the snapshot.
        seconds: stop after so long (live: since the start; a recording: of its own time).
        rate: pictures a second of the MP4; 0 is the recording's own, or 30 live.
        names: write the names of objects and humans into the picture.
        overlay: write frame rate and age into a live picture; None: in a window only.
        fine: smooth edges in films too; None: in those of recordings. Snapshots and sheets are always smooth.
    """

    address: str = ""
    keys: Path | None = None
    replay: Path | None = None
    headless: bool = False
    record: Path | None = None
    snapshot: Path | None = None
    sheet: Path | None = None
    every: int = 0
    size: tuple[int, int] = (1280, 720)
    request: bool = False
    camera: str = "auto"
    position: tuple[float, float, float] | None = None
    look_at: tuple[float, float, float] | None = None
    follow: str = ""
    eyes: str = ""
    at: float | None = None
    seconds: float | None = None
    rate: float = 0.0
    names: bool = False
    overlay: bool | None = None
    fine: bool | None = None

    def __post_init__(self) -> None:
        """Check what a person typed. CommandError: it can't be."""
        if self.camera not in CAMERAS:
            raise CommandError(f'no camera "{self.camera}"; there is: {", ".join(CAMERAS)}')
        if self.camera == CUTS and not (self.replay and self.draws_files):
            raise CommandError("the camera cuts in films, sheets and snapshots of recordings only; leave it out")
        if self.camera == CUTS and (self.position or self.look_at or self.eyes):
            raise CommandError("a camera that cuts chooses its places; leave out --position, --look-at and --eyes")
        if not all(16 <= side <= _LARGEST for side in self.size):
            raise CommandError(f"a picture of {self.size[0]}x{self.size[1]} can't be drawn; each side 16 to {_LARGEST}")
        if self.every < 0 or self.rate < 0.0:
            raise CommandError("--every and --rate can't be negative")

    @property
    def draws_files(self) -> bool:
        """Whether there is to be no window."""
        return self.headless or bool(self.record or self.snapshot or self.sheet)


@dataclass
class ViewReport:
    """What was shown and how fast.

    frames_per_s: pictures a second while there was something new to show. age_ms: how old the worlds were when their
    picture was finished. draw_ms: one picture, from the world to the pixels.
    """

    source: str
    size: tuple[int, int]
    pictures: int = 0
    seconds: float = 0.0
    faces: int = 0
    files: list[str] = field(default_factory=list[str])
    problems: list[str] = field(default_factory=list[str])
    ages: list[float] = field(default_factory=list[float])
    draws: list[float] = field(default_factory=list[float])

    @property
    def frames_per_s(self) -> float:
        """Pictures a second."""
        return self.pictures / self.seconds if self.seconds > 0.0 else 0.0

    def to_json(self) -> dict[str, Any]:
        """Plain types, for `--json`."""
        skipped = ("ages", "draws")
        plain = {f.name: getattr(self, f.name) for f in dataclasses.fields(self) if f.name not in skipped}
        plain["size"] = f"{self.size[0]}x{self.size[1]}"
        plain["seconds"] = round(self.seconds, 3)
        plain["frames_per_s"] = round(self.frames_per_s, 2)
        plain["age_ms"] = _quantiles(self.ages)
        plain["draw_ms"] = _quantiles(self.draws)
        return plain

    def __str__(self) -> str:
        """One line for a person."""
        if not self.pictures and self.draws:
            return f"{self.source}: one picture of {self.size[0]}x{self.size[1]}"
        text = f"{self.source}: {self.pictures} pictures of {self.size[0]}x{self.size[1]} in {self.seconds:.1f} s"
        text += f", {self.frames_per_s:.1f} frames/s"
        if self.ages:
            text += f", the world shown {1e3 * float(np.median(self.ages)):.0f} ms old"
        return text


def _quantiles(values: list[float]) -> dict[str, float] | None:
    """Median and 99th percentile in milliseconds of seconds."""
    if not values:
        return None
    p50, p99 = np.quantile(values, (0.5, 0.99))
    return {"p50": round(1e3 * float(p50), 3), "p99": round(1e3 * float(p99), 3)}
