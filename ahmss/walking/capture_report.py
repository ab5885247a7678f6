"""What became of a folder of captures: every key and what filled it, and what served as no clip."""

from __future__ import annotations

from dataclasses import dataclass

from ahmss.walking.catalogue import Key
from ahmss.walking.cutting import Unused
from ahmss.walking.library import RATE

__all__ = ["Filled", "Report"]


@dataclass(frozen=True)
class Filled:
    """What filled a key: seconds in a file; direction and facing as measured there, degrees; whether it is mirrored.

    length: metres along the way. corrected: degrees by which the joints were turned to fit, the root of the mean square
    over both ends.
    """

    key: Key
    file: str
    begin: float
    end: float
    mirrored: bool
    direction: float
    facing: float
    length: float
    corrected: float


@dataclass(frozen=True)
class Report:
    """What became of a folder of captures.

    filled: the keys that captures filled. fallback: the keys that they left empty and the fallback's clip fills.
    missing: the keys that nothing fills. unused: what was found and serves as no clip. unread: files and why.
    """

    filled: tuple[Filled, ...]
    fallback: tuple[Key, ...]
    missing: tuple[Key, ...]
    unused: tuple[Unused, ...]
    unread: tuple[str, ...]

    def lines(self) -> list[str]:
        """The report in lines to print: every key, then what was found besides."""
        total = len(self.filled) + len(self.fallback) + len(self.missing)
        out = [f"{len(self.filled)} of {total} clips are captured"]
        out += [f"  {_described(one)}" for one in self.filled]
        out.append(f"{len(self.fallback)} were empty and filled with the subject's own clips")
        out += [f"  {key.name}" for key in self.fallback]
        if self.missing:
            out.append(f"{len(self.missing)} are empty")
            out += [f"  {key.name}" for key in self.missing]
        if self.unused:
            out.append("found, and used for nothing:")
            out += [
                f"  {one.file}, {one.first / RATE:.2f} to {one.last / RATE:.2f} s: {one.what}" for one in self.unused
            ]
        return out + [f"not read: {line}" for line in self.unread]


def _described(one: Filled) -> str:
    angles = {
        "start": f"direction {one.direction:.0f}", "end": f"facing {one.facing:.0f}", "straight": "",
        "one_step": f"direction {one.direction:.0f}, facing {one.facing:.0f}",
        "two_step": f"direction {one.direction:.0f}, facing {one.facing:.0f}",
    }[one.key.kind]  # fmt: skip
    measured = f"{angles} degrees, " if angles else ""
    seen = ", mirrored" if one.mirrored else ""
    return (
        f"{one.key.name}: {one.file}, {one.begin:.2f} to {one.end:.2f} s{seen}; {measured}{one.length:.2f} m, "
        f"corrected by {one.corrected:.1f} degrees"
    )
