"""What `ahmss capture` does at the terminal: it reads what was typed, calls one part, and says what came of it."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ahmss.body.skeleton import Skeleton
from ahmss.capture import take as takes
from ahmss.capture.clipping import Captured, Choices, clip_of
from ahmss.capture.config import load, template
from ahmss.capture.record import Progress, record
from ahmss.capture.take import Take
from ahmss.database.workspace import Workspace
from ahmss.errors import CommandError
from ahmss.motion import clip as clips

__all__ = [
    "Wishes",
    "calibrate_take",
    "examine",
    "go_live",
    "print_template",
    "record_clip",
    "simulate_tracker",
]

_EVERY = 5.0  # seconds between two lines where there is no terminal
_KINDS = ("fastrak", "liberty", "patriot", "ultratrak")


@dataclass(frozen=True)
class Wishes:
    """What was typed about the clip: the human, seconds of the upright pose, degrees or `sensors`, mend, hertz."""

    body: str
    upright: tuple[float, float] | None
    facing: str
    mend: bool
    smooth: float
    workspace: Path | None

    def skeleton(self) -> Skeleton:
        """Of the human who shall perform it."""
        return Workspace.find(self.workspace).humans.get(self.body).skeleton

    def choices(self, rate: float) -> Choices:
        """The same in frames and radians."""
        upright = None
        if self.upright is not None:
            if not all(map(math.isfinite, self.upright)):
                raise CommandError(
                    f"--upright {self.upright[0]:g} {self.upright[1]:g}; give the seconds from and to which the "
                    "subject stands upright"
                )
            upright = (round(self.upright[0] * rate), round(self.upright[1] * rate))
        return Choices(upright, facing_of(self.facing), self.mend, self.smooth)


def facing_of(text: str) -> float | None:
    """Degrees as radians; `sensors` as None."""
    if text == "sensors":
        return None
    try:
        degrees = float(text)
    except ValueError:
        degrees = math.nan
    if not math.isfinite(degrees):
        raise CommandError(f'--facing "{text}"; give degrees to the left of the transmitter\'s x, or sensors')
    return math.radians(degrees)


def print_template(kind: str) -> None:
    """A tracker's file to start from."""
    print(template(_one(kind, _KINDS, "--kind")), end="")


def examine(path: Path, *, as_json: bool) -> bool:
    """Say what is the matter with a tracker; whether anything is."""
    from ahmss.capture.doctor import examine_tracker

    return examine_tracker(load(path), as_json=as_json) > 0


def record_clip(
    out: Path, config_path: Path, wishes: Wishes, *, seconds: float | None, wait: float, origin: str, force: bool,
    as_json: bool,
) -> None:  # fmt: skip
    """Record a take and make a clip of it; the take stays whatever becomes of the clip."""
    config, skeleton = load(config_path), wishes.skeleton()
    wishes.choices(config.rate)  # what is wrong with them is said before anybody performs
    take_path = out.with_suffix(".take.npz")
    _keep(take_path, out, force=force)
    _count_down(wait)
    with _status() as tell:
        take, losses = record(config, seconds, tell, origin)
    takes.save(take, take_path)
    _say(f"wrote {take_path}: {take.frames} frames, {take.times[-1]:.1f} s at {take.rate:g} a second")
    _say(losses)
    _make(take, skeleton, wishes, out, as_json=as_json, more={"take": str(take_path), "losses": losses})


def calibrate_take(path: Path, out: Path | None, wishes: Wishes, *, force: bool, as_json: bool) -> None:
    """Make a clip of a take that was recorded before."""
    take = takes.load(path)
    if out is None:
        name = path.name.removesuffix(".npz").removesuffix(".take")
        out = path.with_name(f"{name}.npz")
        if out == path:
            raise CommandError(f"{path} would be overwritten; name the clip with --out FILE")
    _keep(out, force=force)
    _make(take, wishes.skeleton(), wishes, out, as_json=as_json, more={"take": str(path)})


def _keep(*paths: Path, force: bool) -> None:
    """Refuse to write over what is there: a person can't do a take again just so."""
    for path in paths:
        if path.exists() and not force:
            raise CommandError(f"{path}: it is there already; name another, or say --force to write over it")


def go_live(
    config_path: Path, options: dict[str, Any], *, server: str, keys: Path | None, seconds: float | None,
    workspace: Path | None, as_json: bool,
) -> None:  # fmt: skip
    """Let the tracker drive a human of the world."""
    from ahmss.capture.live import Puppet, drive
    from ahmss.world.client import WorldClient
    from ahmss.world.keys import read_client

    config, humans = load(config_path), Workspace.find(workspace).humans
    model = humans.get(options["body"] or options["human"])
    puppet = Puppet(
        options["human"], model, options["place"], float(np.radians(options["heading"])), facing_of(options["facing"])
    )
    with WorldClient(server, keys=read_client(keys) if keys else None) as client:
        latency = drive(config, puppet, humans.shape(model.name), client, _say, seconds)
    _say(latency.sentence)
    if as_json:
        print(json.dumps({"byte_to_server_ms": asdict(latency)}))


def simulate_tracker(
    subject: str, body: str, upright: float, options: dict[str, Any], faults: dict[str, Any], stand: dict[str, Any],
    workspace: Path | None,
) -> None:  # fmt: skip
    """Be a tracker before which somebody performs."""
    from ahmss.capture.casting import performance_of
    from ahmss.capture.config import TransmitterConfig
    from ahmss.capture.simulator.faults import Faults
    from ahmss.capture.simulator.options import SimulatorOptions
    from ahmss.capture.simulator.run import run_simulator

    _one(options["kind"], _KINDS, "--kind")
    _one(options["clock"], ("real", "poll"), "--clock")
    _one(options["after"], ("hold", "loop", "stop"), "--after")
    _one(options["noise"], ("none", "resolution", "full"), "--noise")
    skeleton = Workspace.find(workspace).humans.get(body).skeleton
    performance = performance_of(subject, skeleton, upright)
    run_simulator(
        SimulatorOptions(
            performance=performance, faults=Faults(**faults), transmitter=TransmitterConfig(**stand), **options
        )
    )


def _make(take: Take, skeleton: Skeleton, wishes: Wishes, out: Path, *, as_json: bool, more: dict[str, Any]) -> None:
    """Make a clip of a take, save it, and say what is to be known of it."""
    captured = clip_of(take, skeleton, wishes.choices(take.rate))
    clips.save(captured.clip, out)
    for line in captured.report():
        _say(line)
    _say(f"wrote {out}: {captured.clip.frames} frames, {captured.clip.duration:.1f} s, for {skeleton.name}")
    if as_json:
        print(json.dumps({"clip": str(out), **more, **_figures(captured)}))


def _figures(captured: Captured) -> dict[str, Any]:
    calibration, rate = captured.calibration, captured.clip.rate
    return {
        "frames": captured.clip.frames,
        "rate": rate,
        "upright": [frame / rate for frame in calibration.stretch],
        "upright_others": [[frame / rate for frame in other] for other in calibration.others],
        "stillness_deg": round(calibration.stillness, 3),
        "heading_doubt_deg": round(float(np.degrees(calibration.doubt)), 2),
        "gaps": [asdict(gap) for gap in captured.gaps],
        "carried_per_second": round(captured.carried, 2) or None,
        "beyond_reach": captured.beyond,
        "jumps": [asdict(jump) for jump in captured.jumps],
        "mended": captured.mended,
    }


def _one(word: str, allowed: tuple[str, ...], option: str) -> Any:
    if word not in allowed:
        raise CommandError(f'{option} "{word}"; it must be one of {", ".join(allowed)}')
    return word


def _say(line: str) -> None:
    """To standard error, so that standard output holds nothing but what was asked for."""
    print(line, file=sys.stderr, flush=True)


def _count_down(seconds: float) -> None:
    """Wait, counting aloud."""
    end = time.monotonic() + seconds
    while (left := end - time.monotonic()) > 0.0:
        _say(f"in {left:.0f} s ...")
        time.sleep(min(left, 1.0))


@contextmanager
def _status() -> Generator[Callable[[Progress], None]]:
    """How far a session is: one line that changes where there is a terminal, a line every five seconds elsewhere."""
    _say("recording; Ctrl-C ends it")
    if not sys.stderr.isatty():
        yield _Lines().tell
        return
    from rich.console import Console
    from rich.status import Status

    with Status("waiting for the first frame", console=Console(stderr=True)) as status:
        yield lambda progress: status.update(progress.line)


class _Lines:
    """A line every five seconds, and one whenever what is the matter changes."""

    def __init__(self) -> None:
        self._next, self._silence = time.monotonic(), ""

    def tell(self, progress: Progress) -> None:
        """Print the line, if it is time."""
        if progress.silence != self._silence or time.monotonic() >= self._next:
            self._next, self._silence = time.monotonic() + _EVERY, progress.silence
            _say(progress.line)
