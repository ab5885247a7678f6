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
    and the seconds that it needs for both on the ground; of the swing, how the foot leaves and comes down. Of the
    pelvis: how far it sinks below standing and rises and falls, how much it turns with the leg ahead, drops to the
    swinging side (degrees). Of arms, elbows and trunk: the swing for a full step. Of the head: how far away it looks.
    """

    step: float = 0.766
    frames: int = 33
    both: int = 8
    width: float = 0.095
    toe_out: float = 5.0

    push: float = 61.0
    rise: float = 0.55  # of the push: by which the heel rises slowly, before it does so quickly
    rise_time: float = 0.255  # seconds before the foot leaves
    rise_over: float = 0.065  # and after it
    push_time: float = 0.1
    strike: float = 20.6
    flat_time: float = 0.168
    peak: float = 0.118  # of the swing, after lift-off: when the foot points down most
    clearance: float = 0.0085  # metres
    leap: float = 0.016  # metres that the toes rise besides, early in the swing
    drawn: float = 4.0  # how hard a foot that pushes off is drawn after the body
    slowing: float = 8.2  # how hard a striking foot is still slowing down: at rest before, it would wait in the air

    sink: float = 0.0280
    bob: float = 0.0145
    low: float = -0.01  # of the step, after a foot has landed: when the pelvis is lowest
    turn: float = 5.5
    list: float = 4.3
    tilt: float = 1.0
    nod: float = 1.2  # degrees by which the pelvis tilts to and fro, twice a cycle
    nod_at: float = 0.2  # of the step: when it leans furthest ahead

    sway: float = 4.6  # 1/s: how closely the hips follow the foot that bears
    even: float = 3.1  # the same along the way
    roll: tuple[float, float] = (-0.033, 0.26)  # where under the foot the weight goes from and to, of hip height

    arm: float = 24.5
    arm_ahead: float = 3.0  # degrees by which the swing's middle is before where the arm hangs
    arm_lag: float = -0.05  # seconds after the feet; before them
    elbow: float = 10.0
    trunk: float = 1.75  # how much the chest turns back against the pelvis
    lean: float = 1.6  # degrees of trunk for 1 m/s2 of the hips
    ahead: float = 0.30  # seconds by which the head turns before the body
    sight: float = 1.0  # metres: how far away is what the head keeps to as the body rises and sways


GAIT = Gait()
