"""A take made into a clip of a human: filled, calibrated, brought to the human's joints, and stood on the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import LINKS, PARENTS
from ahmss.body.quaternion import conjugate, multiply, normalize
from ahmss.body.skeleton import Skeleton
from ahmss.capture.calibration import RESTLESS, Calibration, calibrate, link_rotations
from ahmss.capture.repair import Gap, Jump, fill, gaps, jumps, mend
from ahmss.capture.smoothing import smoothed
from ahmss.capture.stations import TRACKED
from ahmss.capture.take import Take
from ahmss.motion.clip import Clip, ClipHeader
from ahmss.motion.edit import begun_at_origin
from ahmss.motion.grounding import ground
from ahmss.motion.importance import derive
from ahmss.motion.resample import continuous

__all__ = ["Captured", "Choices", "clip_of", "joint_rotations"]

_TURNED_AWAY = np.radians(15.0)  # the places of the sensors tell the heading to about 5 degrees
_PARENTS = list(PARENTS[1 : len(TRACKED)])
_MANY = 10  # lines on gaps; of more nobody reads each


@dataclass(frozen=True)
class Choices:
    """What may be decided about a take.

    upright: first frame of the upright pose and the one after its last; None: found. facing: where the subject faced
    in it against the transmitter's x axis, radians to the left; None: from the places of left and right sensors.
    mend: put a smooth way across the jumps. cutoff: hertz, over which the sensors' jitter is smoothed away; 0: not.
    """

    upright: tuple[int, int] | None = None
    facing: float | None = 0.0
    mend: bool = False
    cutoff: float = 0.0


@dataclass(frozen=True)
class Captured:
    """A clip, how its take was calibrated, what the take lacked, and where sensors jumped."""

    clip: Clip
    calibration: Calibration
    gaps: list[Gap]
    jumps: list[Jump]
    mended: bool

    def report(self) -> list[str]:
        """What a person should know of it, a sentence each."""
        rate, (first, end) = self.clip.rate, self.calibration.stretch
        calibration = self.calibration
        lines = [f"stood upright {_when(first, end, rate)}, still to {calibration.stillness:.2f} degrees"]
        if calibration.stillness > RESTLESS:
            lines.append("that is restless: stand stiller, or mark a stiller stretch with --upright FROM TO")
        for other in calibration.others:
            marks = " ".join(f"{frame / rate:.2f}" for frame in other)
            lines.append(f"stood as tall {_when(*other, rate)}: was that the upright pose? then --upright {marks}")
        if abs(calibration.doubt) > _TURNED_AWAY:
            lines.append(
                f"the left and right sensors say that the subject faced {np.degrees(calibration.doubt):+.0f} degrees "
                "from where --facing has it: give the right one, or --facing sensors"
            )
        lines += self._of_gaps()
        how = "mended" if self.mended else "left as it is; --mend puts a smooth way across"
        for jump in self.jumps:
            lines.append(f"{jump.link}: jumps by {jump.degrees:.0f} degrees {_when(jump.first, jump.end, rate)}, {how}")
        return lines

    def _of_gaps(self) -> list[str]:
        """A line for each time that sensors gave nothing; where there are many, a line for each link."""
        rate, together = self.clip.rate, self._gaps_together()
        if len(together) <= _MANY:
            return [f"{_named(links)}: nothing {_when(*when, rate)}, filled" for when, links in together.items()]
        lines: list[str] = []
        for link in TRACKED:
            own = [(gap.end - gap.first, gap) for gap in self.gaps if gap.link == link]
            if not own:
                continue
            longest = max(own, key=lambda pair: pair[0])[1]
            times, frames = "once" if len(own) == 1 else f"{len(own)} times", sum(length for length, _ in own)
            lines.append(
                f"{link}: nothing {times}, {frames / rate:.2f} s in all, the longest "
                f"{_when(longest.first, longest.end, rate)}, filled"
            )
        return lines

    def _gaps_together(self) -> dict[tuple[int, int], list[str]]:
        """The links that gave nothing, by the frames in which they did not."""
        together: dict[tuple[int, int], list[str]] = {}
        for gap in sorted(self.gaps, key=lambda gap: gap.first):
            together.setdefault((gap.first, gap.end), []).append(gap.link)
        return together


def _named(links: list[str]) -> str:
    """All that most have in common is said shortly."""
    if len(links) == len(TRACKED):
        return "all sensors"
    others = [link for link in TRACKED if link not in links]
    return f"all sensors but {', '.join(others)}" if len(others) < 4 else ", ".join(links)


def _when(first: int, end: int, rate: float) -> str:
    return f"from {first / rate:.2f} to {end / rate:.2f} s"


def clip_of(take: Take, skeleton: Skeleton, choices: Choices | None = None, posture: Array | None = None) -> Captured:
    """The clip of a take, in the human's floor frame at its first frame, with derived importance and relaxed fingers.

    Args:
        take: as it came.
        skeleton: the human who shall perform it.
        choices: what was decided about it.
        posture: (15, 4) the links' rotations in which the subject stood, were they to face +x; upright if left out.

    Raises:
        DataError: nobody stands still in it, or a sensor gave nothing at all.
    """
    choices = choices or Choices()
    missing = gaps(take)
    whole = fill(take)
    jumping = jumps(whole)
    if choices.mend:
        whole = mend(whole, jumping)
    whole = smoothed(whole, choices.cutoff)
    calibration = calibrate(whole, posture, choices.upright, choices.facing)
    links = link_rotations(whole.world_rotations(), calibration.sensor_to_link)
    fingers = skeleton.relaxed()[0][len(TRACKED) :]
    grounded = ground(skeleton, continuous(joint_rotations(links, fingers)), None, take.rate)
    clip = Clip(
        rotations=grounded.rotations,
        root=grounded.root,
        importance=np.ones((take.frames, len(LINKS) + 1)),
        contacts=grounded.contacts,
        rate=take.rate,
        header=ClipHeader(origin=take.header.origin, human=skeleton.name),
    )
    return Captured(derive(begun_at_origin(clip), skeleton), calibration, missing, jumping, choices.mend)


def joint_rotations(world: Array, fingers: Array) -> Array:
    """Rotations parent <- child (..., 43, 4) of the tracked links' world rotations (..., 15, 4).

    Args:
        world: (..., 15, 4) unit quaternions, world <- link.
        fingers: (28, 4) what nobody measures, parent <- child: those of a relaxed hand.
    """
    tracked = world.shape[-2]
    out = np.empty((*world.shape[:-2], len(LINKS), 4))
    out[..., tracked:, :] = fingers
    out[..., 0, :] = world[..., 0, :]
    out[..., 1:tracked, :] = multiply(conjugate(world[..., _PARENTS, :]), world[..., 1:, :])
    return normalize(out)
