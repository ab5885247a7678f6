"""Random damage to a tracker's bytes, and what of it goes unseen.

`python -m tests.capture.damage 1000000` prints the table of docs/trackers.md.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.quaternion import from_rotation_vector
from ahmss.capture.assembly import Assembler, Sweep
from ahmss.capture.formats import fastrak_ascii, fastrak_binary, liberty, ultratrak
from ahmss.capture.formats.layout import Layout
from ahmss.capture.formats.losses import Losses
from ahmss.capture.formats.parser import PatternParser
from ahmss.capture.merge import Merger
from ahmss.capture.plausible import Gate, possible
from ahmss.capture.stations import Reading, Status, TrackerFrame
from ahmss.capture.udp import Numbers

RATE = 60.0
LOOP = 240  # frames until the motion repeats
LINKS = 15
EVENTS = 1 / 500  # damages a byte of a line
EVENTS_UDP = 1 / 5000
NEAR = 3  # frames within which a value that was sent is that value come late


@dataclass(frozen=True)
class Format:
    """A record format under test; ULTRATRAK, whose records come in datagrams, has no parser."""

    name: str
    layout: Layout
    encode: Callable[[Reading, Layout], bytes]
    parser: Callable[[Layout], PatternParser] | None


FORMATS = {
    form.name: form
    for form in (
        Format("FASTRAK ASCII, quaternion", Layout((2, 11, 1), "cm"), fastrak_ascii.encode, fastrak_ascii.parser),
        Format("FASTRAK ASCII, Euler", Layout((2, 4, 1), "inch"), fastrak_ascii.encode, fastrak_ascii.parser),
        Format("FASTRAK binary, quaternion", Layout((2, 11, 1), "cm"), fastrak_binary.encode, fastrak_binary.parser),
        Format("FASTRAK binary, Euler", Layout((2, 4, 1), "inch"), fastrak_binary.encode, fastrak_binary.parser),
        Format("Liberty, quaternion", Layout((2, 7, 8, 9, 1), "cm"), liberty.encode, liberty.parser),
        Format("Liberty, Euler", Layout((2, 5, 8, 9, 1), "inch"), liberty.encode, liberty.parser),
        Format("ULTRATRAK", Layout((2, 11), "cm"), liberty.encode, None),
    )
}


@dataclass
class Outcome:
    """What came of a run. Sizes are of the wrong values that were given as good: metres, radians."""

    frames: int = 0
    records: int = 0
    damaged: int = 0
    given: int = 0
    wrong: int = 0
    far: int = 0
    metres: float = 0.0
    radians: float = 0.0
    losses: Losses = field(default_factory=Losses)

    def row(self, name: str) -> str:
        """A line of the table in docs/trackers.md."""
        return (
            f"| {name} | {self.frames:,} | {self.records:,} | {100 * self.damaged / self.records:.1f} % | "
            f"{100 * (self.given - self.wrong) / self.records:.2f} % | {1e6 * self.wrong / self.damaged:,.0f} | "
            f"{1e6 * self.far / self.damaged:,.0f} | {100 * self.metres:.0f} cm, {np.degrees(self.radians):.0f}° |"
        )


def motion() -> tuple[Array, Array]:
    """Places (LOOP, 15, 3) and rotations (LOOP, 15, 4) of a motion of up to 4 m/s, with a tracker's jitter."""
    rng = np.random.default_rng(5)
    turn = 2.0 * np.pi * np.arange(LOOP) / LOOP
    beats = rng.integers(1, 5, (2, LINKS, 3))
    phases = rng.uniform(0.0, 2.0 * np.pi, (2, LINKS, 3))
    waves = np.sin(turn[:, None, None, None] * beats + phases)
    places = rng.uniform(-0.8, 0.8, (LINKS, 3)) + 0.35 * waves[:, 0] + rng.normal(0.0, 0.0013, (LOOP, LINKS, 3))
    rotations = from_rotation_vector(0.9 * waves[:, 1] + rng.normal(0.0, 0.0017, (LOOP, LINKS, 3)))
    return places, rotations


def clean(form: Format) -> NDArray[np.uint8]:
    """The undamaged bytes of the loop: (LOOP, 15, bytes of a record), or (LOOP, bytes of a datagram)."""
    places, rotations = motion()
    rows: list[bytes] = []
    for frame in range(LOOP):
        readings = [
            Reading(at + 1, "", tuple(places[frame, at]), tuple(rotations[frame, at]), 0, 0.0) for at in range(LINKS)
        ]
        if form.parser is None:
            rows.append(ultratrak.encode(100_000_000, readings, form.layout.units))
        else:
            rows += [form.encode(reading, form.layout) for reading in readings]
    data = np.frombuffer(b"".join(rows), np.uint8)
    return data.reshape(LOOP, -1) if form.parser is None else data.reshape(LOOP, LINKS, -1)


def truth(form: Format, block: NDArray[np.uint8]) -> Array:
    """(LOOP, 15, 7) what an undamaged record says, exactly: place and rotation."""
    if form.parser is None:
        frames = [ultratrak.decode(row.tobytes(), form.layout.units, Losses()) for row in block]
        readings = [reading for frame in frames if frame for reading in frame.readings]
    else:
        readings = form.parser(form.layout).feed(block.tobytes())
    return np.array([(*reading.position, *reading.rotation) for reading in readings]).reshape(LOOP, LINKS, 7)


def numbered(form: Format, block: NDArray[np.uint8], first: int) -> NDArray[np.uint8]:
    """The block with its frame numbers and time stamps: frames `first` and on."""
    block = block.copy()
    numbers = np.arange(first, first + LOOP)
    if form.encode is liberty.encode and form.parser is not None:
        tail = np.stack([np.round(numbers * 1000 / RATE), numbers], axis=-1).astype("<u4").view(np.uint8)
        block[..., -10:-2] = tail[:, None]
    elif form.parser is None:
        digits = (100_000_000 + numbers)[:, None] // 10 ** np.arange(8, -1, -1) % 10 + ord("0")
        block[:, 6:15] = digits.astype(np.uint8)
    return block


def damaged(
    data: NDArray[np.uint8], rng: np.random.Generator, events: float = EVENTS
) -> tuple[NDArray[np.uint8], NDArray[np.intp]]:
    """A stream with bytes dropped, doubled and flipped (a bit, or all), and where that was."""
    where = np.flatnonzero(rng.random(len(data)) < events)
    kinds = rng.integers(0, 4, len(where))
    flips = np.where(kinds == 2, 1 << rng.integers(0, 8, len(where)), rng.integers(1, 256, len(where)))
    out = data.copy()
    out[where[kinds >= 2]] ^= flips[kinds >= 2].astype(np.uint8)
    copies = np.ones(len(data), np.intp)
    copies[where[kinds == 0]] = 0
    copies[where[kinds == 1]] = 2
    return np.repeat(out, copies), where


class Chain:
    """All of the driver between the bytes and the program."""

    def __init__(self, form: Format) -> None:
        self.losses = Losses()
        self.form = form
        self.parser = form.parser(form.layout) if form.parser else None
        if self.parser:
            self.parser.losses = self.losses
        numbering = "count" if 9 in form.layout.items else "clock"
        self.assembler = Assembler(range(1, LINKS + 1), RATE, self.losses, numbering=numbering)
        self.merger = Merger(1, RATE, self.losses, ordered=form.parser is not None)
        self.gate = Gate({station: station - 1 for station in range(1, LINKS + 1)}, RATE, self.losses)
        self.numbers = Numbers(RATE)

    def feed(self, data: bytes, now: float) -> list[TrackerFrame]:
        """The frames that these bytes (or this datagram) complete."""
        for sweep in self._sweeps(data, now):
            self.merger.add(0, sweep)
        return [self.gate.frame(merged) for merged in self.merger.take(now)]

    def _sweeps(self, data: bytes, now: float) -> list[Sweep]:
        if self.parser:
            return self.assembler.feed(self.parser.feed(data, now)) + self.assembler.flush(now)
        frame = ultratrak.decode(data, self.form.layout.units, self.losses, now)
        fresh = self.numbers.judge(frame.number, now) if frame else None
        if frame is None or fresh is None:
            return []
        return [Sweep(frame.number, {reading.station: reading for reading in frame.readings}, now, fresh)]


def pieces(
    form: Format, block: NDArray[np.uint8], first: int, rng: np.random.Generator, outcome: Outcome
) -> Iterator[tuple[bytes, float]]:
    """The damaged stream as reads give it (ULTRATRAK: datagrams, some lost, doubled, late), with times."""
    block = numbered(form, block, first)
    if form.parser is not None:
        stream, where = damaged(block.reshape(-1), rng)
        outcome.damaged += len(np.unique(where // block.shape[2]))
        cuts = np.cumsum(rng.integers(1, 2 * block.shape[1] * block.shape[2], 4 * LOOP))
        start = 0
        for end in [*cuts[cuts < len(stream)].tolist(), len(stream)]:
            yield stream[start:end].tobytes(), (first + LOOP * end / len(stream)) / RATE
            start = end
        return
    order = np.argsort(np.arange(LOOP) + 1.5 * (rng.random(LOOP) < 0.02), kind="stable")
    for at in np.repeat(order, rng.choice([0, 1, 2], LOOP, p=[0.01, 0.98, 0.01])).tolist():
        datagram, where = damaged(block[at], rng, EVENTS_UDP)
        outcome.damaged += len(np.unique(np.maximum(where - 56, 0) // 33))
        yield datagram.tobytes(), (first + at) / RATE


def run(form: Format, frames: int, seed: int = 0) -> Outcome:
    """Send so many frames through the chain, damaged, and compare what is given as good with what was sent.

    Raises:
        AssertionError: a frame given as good is not unit, not in range, or not plausible beside its neighbour.
    """
    rng = np.random.default_rng(seed)
    block = clean(form)
    sent = truth(form, block)
    outcome, chain = Outcome(), Chain(form)
    last: TrackerFrame | None = None
    for first in range(0, frames, LOOP):
        came = [frame for data, now in pieces(form, block, first, rng, outcome) for frame in chain.feed(data, now)]
        outcome.frames += LOOP
        outcome.records += LOOP * LINKS
        check([last, *came] if last else came)
        compare(came, sent, outcome, counted=9 in form.layout.items or form.parser is None)
        last = came[-1] if came else last
    outcome.losses = chain.losses
    return outcome


def check(frames: list[TrackerFrame]) -> None:
    """Unit, in range, numbers rising, and plausible beside the frame before."""
    if not frames:
        return
    rotations = np.stack([frame.rotations for frame in frames])
    places = np.stack([frame.positions for frame in frames])
    good = np.stack([frame.status for frame in frames]) <= Status.WEAK
    numbers = np.array([frame.number for frame in frames])
    times = np.array([frame.time for frame in frames])
    assert np.isfinite(places).all()
    assert np.abs(np.linalg.norm(rotations, axis=-1) - 1.0).max() < 1e-9
    assert np.linalg.norm(places, axis=-1).max() < 9.2 + 1e-9
    steps = np.diff(numbers)
    assert (steps > 0).all()
    assert (np.diff(times) >= 0.0).all()
    beside = good[1:] & good[:-1]
    allowed = possible(
        (places[:-1], places[1:]), (rotations[:-1], rotations[1:]), (steps / RATE)[:, None] + np.zeros(LINKS)
    )
    assert allowed[beside].all()


def compare(frames: list[TrackerFrame], sent: Array, outcome: Outcome, *, counted: bool) -> None:
    """Count what was given as good and never sent, and how far off it is; without a count the arrival tells when."""
    if not frames:
        return
    values = np.concatenate([np.stack([f.positions for f in frames]), np.stack([f.rotations for f in frames])], axis=-1)
    good = np.stack([frame.status for frame in frames]) <= Status.WEAK
    numbers = np.array([frame.number if counted else round(frame.arrival * RATE) - 1 for frame in frames])
    metres, radians = np.full(good.shape, np.inf), np.full(good.shape, np.inf)
    same = np.zeros(good.shape, bool)
    for at in range(-NEAR, NEAR + 1):
        then = sent[(numbers + at) % LOOP]
        cosine = np.einsum("...i,...i->...", then[..., 3:], values[..., 3:])
        turned = np.where(cosine[..., None] < 0.0, -1.0, 1.0) * then[..., 3:]
        same |= (then[..., :3] == values[..., :3]).all(axis=-1) & (turned == values[..., 3:]).all(axis=-1)
        metres = np.minimum(metres, np.linalg.norm(values[..., :3] - then[..., :3], axis=-1))
        radians = np.minimum(radians, 2.0 * np.arccos(np.minimum(np.abs(cosine), 1.0)))
    wrong = good & ~same
    outcome.given += int(good.sum())
    outcome.wrong += int(wrong.sum())
    if wrong.any():
        outcome.far += int(((metres > 0.01) | (radians > np.radians(1.0)))[wrong].sum())
        outcome.metres = max(outcome.metres, float(metres[wrong].max()))
        outcome.radians = max(outcome.radians, float(radians[wrong].max()))


HEADING = (
    "| record format | frames | records | damaged | given right | given wrong, per million damaged | "
    "of these off by over 1 cm or 1° | largest |\n|---|---|---|---|---|---|---|---|"
)


def main() -> None:
    """Print the table of docs/trackers.md; the argument is how many frames, spread over the formats."""
    frames = int(sys.argv[1]) if len(sys.argv) > 1 else 70_000
    print(HEADING)
    for form in FORMATS.values():
        print(run(form, frames // len(FORMATS)).row(form.name), flush=True)


if __name__ == "__main__":
    main()
