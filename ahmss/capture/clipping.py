"""A take made into a clip of a human: filled, calibrated, brought to the human's joints, and stood on the ground."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.body.array import Array
from ahmss.body.links import LINKS, PARENTS
from ahmss.body.quaternion import conjugate, multiply, normalize
from ahmss.body.skeleton import Skeleton
from ahmss.capture.calibration import RESTLESS, Calibration, calibrate, link_rotations
from ahmss.capture.formats.decode import REACH
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
_EDGE = 0.5  # metres from the end of the reach, within which who is lost has gone beyond it
_FULL = 0.95  # share of frames that come; where it is less all the time the line does not carry more
_SHORT = 0.2  # seconds; longer gaps are not for a line that is over-full
_PARTS = 10  # of a take: what is so in all of them is so all the time


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
    """A clip, how its take was calibrated, what the take lacked, and where sensors jumped.

    carried: frames a second that came of each sensor where the line carried no more, else 0. beyond: whether sensors
    were lost at the end of the transmitter's reach.
    """

    clip: Clip
    calibration: Calibration
    gaps: list[Gap]
    jumps: list[Jump]
    mended: bool
    carried: float = 0.0
    beyond: bool = False

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
        if self.beyond:
            lines.append(
                f"sensors gave nothing near {REACH:g} m from the transmitter: records from beyond its reach have "
                "values that can't be; stay nearer"
            )
        how = "mended" if self.mended else "left as it is; --mend puts a smooth way across"
        for jump in self.jumps:
            lines.append(f"{jump.link}: jumps by {jump.degrees:.0f} degrees {_when(jump.first, jump.end, rate)}, {how}")
        return lines

    def _of_gaps(self) -> list[str]:
        """A line for each time that sensors gave nothing; where there are many, one for all that lack the same."""
        rate, gaps = self.clip.rate, self.gaps
        lines: list[str] = []
        if self.carried:
            gaps = [gap for gap in gaps if gap.end - gap.first > _SHORT * rate]
            lines.append(
                f"all sensors: {self.carried:.1f} frames a second came, filled, not the {rate:g} that are asked for: "
                "the line carries no more; raise its baud rate, use binary, or spread the stations over more lines"
            )
        together = _together(gaps)
        if len(together) <= _MANY:
            return lines + [
                f"{_named(links)}: nothing {_when(*when, rate)}, filled" for when, links in together.items()
            ]
        everywhere = [when for when, links in together.items() if len(links) == len(TRACKED)]
        alike: dict[tuple[tuple[int, int], ...], list[str]] = {tuple(everywhere): list(TRACKED)} if everywhere else {}
        for link in TRACKED:
            own = [when for when, links in together.items() if link in links and when not in everywhere]
            if own:
                alike.setdefault(tuple(own), []).append(link)
        return lines + [_many(_named(links), stretches, rate) for stretches, links in alike.items()]


def _together(gaps: list[Gap]) -> dict[tuple[int, int], list[str]]:
    """The links that gave nothing, by the frames in which they did not."""
    together: dict[tuple[int, int], list[str]] = {}
    for gap in sorted(gaps, key=lambda gap: gap.first):
        together.setdefault((gap.first, gap.end), []).append(gap.link)
    return together


def _many(who: str, stretches: tuple[tuple[int, int], ...], rate: float) -> str:
    """A line on all stretches (first, end) in which these sensors gave nothing."""
    longest = max(stretches, key=lambda stretch: stretch[1] - stretch[0])
    times, frames = "once" if len(stretches) == 1 else f"{len(stretches)} times", sum(end - at for at, end in stretches)
    return f"{who}: nothing {times}, {frames / rate:.2f} s in all, the longest {_when(*longest, rate)}, filled"


def _carried(take: Take) -> float:
    """Frames a second that came of each sensor where it is less than was asked for all the time, else 0."""
    came = ~take.missing
    shares = (
        [float(np.median(part.mean(axis=0))) for part in np.array_split(came, _PARTS)] if len(came) > _PARTS else []
    )
    return float(np.median(came.mean(axis=0)) * take.rate) if shares and max(shares) < _FULL else 0.0


def _beyond(take: Take, missing: list[Gap]) -> bool:
    """Whether a sensor was lost, or came back, at the end of the transmitter's reach."""
    away = np.linalg.norm(take.positions, axis=-1)
    ends = [(k, TRACKED.index(gap.link)) for gap in missing for k in (gap.first - 1, gap.end) if 0 <= k < take.frames]
    return any(away[end] > REACH - _EDGE for end in ends)


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
    moved = derive(begun_at_origin(clip), skeleton)
    return Captured(moved, calibration, missing, jumping, choices.mend, _carried(take), _beyond(take, missing))


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
