"""How people walk, in numbers: what the subject of our own goes by.

Measured on public captures of three people and on published curves of normal gait (Winter 2009, Schwartz 2008, Schulz
2011, Murakami & Otaka 2017). Lengths are shares of the hip's height, times are seconds or shares of a step.
"""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["GAIT", "Gait"]


@dataclass(frozen=True)
class Gait:
    """A style of walking.

    Of the straight step: its length, frames (at 60 a second) and how long both feet stand in it; the ankles' distance
    across, the feet's turn out. Of the foot: its pitch at the most when it pushes off and when it strikes (toes up),
    and the seconds that it needs for both on the ground; the sole's clearance in the swing. Of the pelvis: how far it
    sinks below standing and rises and falls, how much it turns with the leg ahead, drops to the swinging side
    (degrees). Of arms, elbows and trunk: the swing for a full step.
    """

    step: float = 0.74
    frames: int = 33
    both: int = 7
    width: float = 0.095
    toe_out: float = 5.0

    push: float = 52.0
    strike: float = 20.0
    push_time: float = 0.205
    flat_time: float = 0.16
    peak: float = 0.15  # of the swing, after lift-off: when the foot points down most
    clearance: float = 0.012  # metres

    sink: float = 0.0285
    bob: float = 0.018
    low: float = -0.02  # of the step, after a foot has landed: when the pelvis is lowest
    turn: float = 5.5
    list: float = 4.3
    tilt: float = 1.0
    nod: float = 1.2  # degrees by which the pelvis tilts to and fro, twice a cycle
    nod_at: float = 0.2  # of the step: when it leans furthest ahead

    sway: float = 4.6  # 1/s: how closely the hips follow the foot that bears
    even: float = 3.7  # the same along the way
    roll: tuple[float, float] = (-0.01, 0.20)  # where under the foot the weight goes from and to, shares of hip height

    arm: float = 23.5
    arm_rest: float = 1.0
    arm_lag: float = -0.05  # seconds after the feet; before them
    elbow: float = 10.0
    trunk: float = 1.75  # how much the chest turns back against the pelvis
    lean: float = 1.6  # degrees of trunk for 1 m/s2 of the hips
    ahead: float = 0.30  # seconds by which the head turns before the body


GAIT = Gait()
