"""How quickly a motion may be made: who is asked for it in fewer frames than a person needs takes as many as they need.

What the shipped algorithms that say themselves when they are over share, and an author may use.
"""

from __future__ import annotations

from math import ceil

from ahmss.algorithm.task import HumanTask

__all__ = ["hurried", "least", "too_few"]

_HASTE = 0.4  # of the frames that a motion takes at ease: who hurries is two and a half times as fast, and no faster


def too_few(asked: int, fewest: int) -> str:
    """What is said to who asked for fewer frames than it takes."""
    return f"{asked} frame{' is' if asked == 1 else 's are'} too few; it takes {fewest}"


def least(task: HumanTask, at_ease: int) -> int:
    """The fewest frames, 1 or more, in which a part of a motion is made that takes so many at ease.

    Where main counts them, and ends the motion after the last, it is 1: there is no more time.
    """
    return max(ceil(_HASTE * at_ease), 1) if task.message.wish else 1


def hurried(task: HumanTask, at_ease: int, besides: int = 0) -> int:
    """The frames of a part of a motion: as at ease, or what was asked for, but no fewer than a person needs.

    Where they are more than were asked for the person is told so, once; from there on the task is as long as that.

    Args:
        task: whose motion it is. at_ease: frames of the part where nobody says how many.
        besides: frames of the motion that are not the part's.
    """
    if not task.length:
        return at_ease
    left, fewest = task.length - besides, least(task, at_ease)
    if left >= fewest:
        return left
    if task.message.wish:
        if task.length == task.message.frames:
            task.note(too_few(task.length, besides + fewest))
        task.length = besides + fewest
    return fewest
