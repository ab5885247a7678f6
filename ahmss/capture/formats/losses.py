"""What was lost between a tracker and its frames: counted where it happens, told in one sentence."""

from __future__ import annotations

from dataclasses import asdict, dataclass, fields

__all__ = ["Losses"]

_WORDS = {
    "skipped_bytes": "bytes that belong to no record",
    "resyncs": "times that the next record had to be searched for",
    "damaged": "records with values that can't be",
    "miscounted": "records with a frame number that can't be",
    "foreign": "datagrams that are no tracker's",
    "repeated": "frames that came twice",
    "late": "frames that came too late",
    "lost": "frames that never came",
    "missing": "stations missing from a frame",
    "weak": "readings that the device calls weak",
    "implausible": "readings that no body could have",
    "reopened": "times that a line was opened again",
}


@dataclass
class Losses:
    """Counts since the start. `records` and `frames` are what came well; all others are what did not."""

    records: int = 0
    frames: int = 0
    skipped_bytes: int = 0
    resyncs: int = 0
    damaged: int = 0
    miscounted: int = 0
    foreign: int = 0
    repeated: int = 0
    late: int = 0
    lost: int = 0
    missing: int = 0
    weak: int = 0
    implausible: int = 0
    reopened: int = 0

    def __add__(self, other: Losses) -> Losses:
        """The counts of two lines together."""
        return Losses(*(getattr(self, field.name) + getattr(other, field.name) for field in fields(self)))

    @property
    def sentence(self) -> str:
        """`1203 frames of 18045 records; lost: 3 records with values that can't be`."""
        counts = asdict(self)
        lost = [f"{counts[name]} {words}" for name, words in _WORDS.items() if counts[name]]
        return f"{self.frames} frames of {self.records} records; " + (
            f"lost: {', '.join(lost)}" if lost else "nothing lost"
        )
