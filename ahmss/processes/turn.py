"""How an algorithm takes turns on the processor: long ones, so that frames go before what it thinks.

Linux gives the processor to the one whose turn is over first (EEVDF, 6.6; turns of one's own: 6.12), so that a motion
that thinks for a second in the usual turns of 1 to 3 ms stands again and again before the frames of every main; on a
full processor these come late. In turns of 20 ms it gets as much of the processor, and frames go between. That needs
no right. Where the system knows no turns nothing is changed.
"""

from __future__ import annotations

import ctypes
import os
import platform
import struct
import sys

__all__ = ["take_long_turns"]

_TURN = 20_000_000  # nanoseconds
_USUAL = 0  # the policy (SCHED_OTHER)
_SET_ATTRIBUTES = {"x86_64": 314, "aarch64": 274}  # the number of sched_setattr
_ATTRIBUTES = struct.Struct("=IIQiIQQQ")  # size, policy, flags, nice, priority, turn, deadline, period


def take_long_turns() -> None:
    """Let frames go before what this process, and what it starts, thinks. An older system refuses: all is as it was."""
    number = _SET_ATTRIBUTES.get(platform.machine())
    if sys.platform == "linux" and number is not None:
        nice = os.getpriority(os.PRIO_PROCESS, 0)
        wanted = _ATTRIBUTES.pack(_ATTRIBUTES.size, _USUAL, 0, nice, 0, _TURN, 0, 0)
        ctypes.CDLL(None).syscall(number, 0, wanted, 0)
