"""The sensors' jitter smoothed away without delay."""

from __future__ import annotations

from dataclasses import replace

from scipy.signal import butter, sosfiltfilt

from ahmss.body.quaternion import normalize
from ahmss.capture.take import Take
from ahmss.errors import CommandError
from ahmss.motion.resample import continuous

__all__ = ["smoothed"]


def smoothed(take: Take, cutoff: float) -> Take:
    """The take through a zero-phase Butterworth filter of second order; a cutoff of 0 leaves it as it is.

    Args:
        take: without drop-outs, or with them filled.
        cutoff: hertz. Body links move below 6 to 10 Hz; a foot that lands needs the most.

    Raises:
        CommandError: the cutoff is negative, or not below half the take's rate.
    """
    if cutoff == 0.0:
        return take
    if not 0.0 < cutoff < take.rate / 2.0:
        raise CommandError(f"can't smooth at {cutoff:g} Hz; give 0 for none, or less than {take.rate / 2.0:g}")
    sos = butter(2, cutoff, fs=take.rate, output="sos")
    rotations = normalize(sosfiltfilt(sos, continuous(take.rotations), axis=0))
    return replace(take, rotations=rotations, positions=sosfiltfilt(sos, take.positions, axis=0))
