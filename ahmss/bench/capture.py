"""What real motion capture measures, for comparison: figures alone, no motion.

All are of public clips of one performer (Advanced Computing Center for the Arts and Design, The Ohio State University:
ACCAD Female1), measured on the performer's own skeleton as `ahmss motion quality` does it. Pops and the hips are
measured at 60 Hz, on a human of ours that performs the clip. A clip with a known glitch (B02) is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["IN_PLACE", "STANDING", "WALKING", "Bar"]


@dataclass(frozen=True, slots=True)
class Bar:
    """The most that real capture of a kind of movement measures.

    clips: which they were. slide: cm a stance. speed_p95: m/s of the slower foot, 95th percentile. acceleration
    (rad/s2): of the body's joints, the largest and the 99th percentile; jerk (rad/s3) the largest. pop: degrees by
    which a step from frame to frame differs from its neighbours' mean. hips: m/s2. floor: mm that a foot is measured
    under it.
    """

    clips: str
    slide: float
    speed_p95: float
    acceleration: float
    acceleration_p99: float
    jerk: float
    pop: float
    hips: float
    floor: float


WALKING = Bar(
    "walking", slide=6.5, speed_p95=0.212, acceleration=382.0, acceleration_p99=213.0, jerk=15_000.0,
    pop=6.0, hips=24.0, floor=30.0,
)  # fmt: skip
"""Joints, slide and speed: the largest of several straight walks and a turn of 90 degrees; pop and hips: of B03_Walk1,
where the walking turns read up to 9.8 degrees and 38 m/s2; floor: the least of five walks (30 to 73 mm)."""

IN_PLACE = Bar(
    "a box picked up", slide=7.0, speed_p95=0.026, acceleration=81.0, acceleration_p99=40.0, jerk=3_860.0,
    pop=2.1, hips=8.5, floor=6.3,
)  # fmt: skip
"""A05_PickUpBox, 6.3 s: the one clip in which something is done with the hands. It is unhurried."""

STANDING = Bar(
    "standing", slide=1.6, speed_p95=0.01, acceleration=30.0, acceleration_p99=19.0, jerk=1_300.0, pop=0.7,
    hips=2.5, floor=2.6,
)  # fmt: skip
"""A01_Stand, 3.0 s: of somebody who does nothing."""
