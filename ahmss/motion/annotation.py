"""What sensors can't tell of a captured motion, added to its clip as a table says that is written by hand.

Fifteen sensors see neither fingers nor the door that a hand is on, and no joint says how much it matters. The table
does: which seconds to keep, importance over time (Ichiguchi 2000, 4.2), fingers, what hand and gaze are on, where the
object was.
"""

from __future__ import annotations

from dataclasses import replace

import msgspec
import numpy as np
from numpy.typing import NDArray

from ahmss.body.array import Array
from ahmss.body.inverse import GAZE, LEFT_HAND, RIGHT_HAND, grips
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, slerp
from ahmss.body.skeleton import Skeleton
from ahmss.motion.annotation_table import (
    LIMBS,
    SIDES,
    Grip,
    Importance,
    Kept,
    Row,
    Shape,
    Side,
    Table,
    Whereabouts,
    load_table,
)  # fmt: skip
from ahmss.motion.clip import Clip
from ahmss.motion.easing import minimum_jerk
from ahmss.motion.edit import cut
from ahmss.motion.fingers import Cylinder, closed, opened

__all__ = ["Table", "annotate", "load_table"]

_ROWS: dict[Side, int] = {"right": RIGHT_HAND, "left": LEFT_HAND}
_UP = np.array([0.0, 0.0, 1.0])
_INTO_FINGERS = 0.016  # metres from the palm's middle to what is held, towards the fingers
_FIST = 0.02  # metres: a fist closes around next to nothing


def annotate(clip: Clip, table: Table, skeleton: Skeleton) -> Clip:
    """The captured clip with what the table says of it.

    Args:
        clip: frames at even times, relative to the human's floor frame.
        table: what is to be added.
        skeleton: the human whose clip it is; its hands say where the palms are and how fingers close.

    Raises:
        ValueError: the table keeps a part that the clip does not have.
    """
    clip = _kept(clip, table.keep)
    time = np.arange(clip.frames) / clip.rate
    rotations = clip.rotations.copy()
    for side in SIDES:
        _shape_fingers(rotations, skeleton, side, [row for row in table.fingers if row.hand == side], time)
    contacts = clip.contacts.copy()
    for row in table.contact:
        contacts[_within(row, time), SIDES.index(row.foot)] = float(row.bears)
    annotated = replace(
        clip, rotations=rotations, contacts=contacts, targets=_targets(clip, table, skeleton, time),
        importance=_importance(clip.importance, table.importance, time),
    )  # fmt: skip
    return annotated if table.object is None else _relative(annotated, table.object)


def _kept(clip: Clip, keep: Kept) -> Clip:
    last = clip.frames - 1 if keep.end is None else round(keep.end * clip.rate)
    return cut(clip, round(keep.begin * clip.rate), last)


def _within(row: Row, time: Array) -> NDArray[np.bool_]:
    return (time >= row.begin - 1e-9) & (time <= _end(row, time) + 1e-9)


def _end(row: Row, time: Array) -> float:
    return float(time[-1]) if row.end is None else row.end


def _share(row: Row, time: Array, ease: float) -> Array:
    """1 from the row's beginning to its end (F,), coming and going by minimum jerk in the seconds beside."""
    ease = max(ease, 1e-6)
    coming = minimum_jerk((time - row.begin) / ease + 1.0)
    return coming * (1.0 - minimum_jerk((time - _end(row, time)) / ease))


def _importance(importance: Array, rows: list[Importance], time: Array) -> Array:
    """The clip's importance (F, 44) with the rows' in its place, later ones over earlier ones."""
    out = importance.copy()
    for row in rows:
        share = _share(row, time, row.ease)[:, None]
        for name, value in row.joints.items():
            links = list(LIMBS[name] if name in LIMBS else (INDEX[name],))
            out[:, links] += share * (value - out[:, links])
    return out


def _shape_fingers(rotations: Array, skeleton: Skeleton, side: Side, rows: list[Shape], time: Array) -> None:
    """Fingers that go from shape to shape, in the rotations (F, 43, 4)."""
    links = list(fingers(side))
    for row in sorted(rows, key=lambda row: row.begin):
        done = minimum_jerk((time - row.begin) / max(_end(row, time) - row.begin, 1e-6))
        rotations[:, links] = slerp(rotations[:, links], _hand_shape(skeleton, side, row), done[:, None])


def _hand_shape(skeleton: Skeleton, side: Side, row: Shape) -> Array:
    """The fingers (14, 4) of a shape."""
    if row.shape == "relaxed":
        return skeleton.relaxed()[0][list(fingers(side))]
    if row.shape == "open":
        return opened(side)
    radius = 0.5 * (row.diameter or _FIST)
    palm = skeleton.grips[_ROWS[side]]
    out, thumb = rotate(palm[3:], np.array([1.0, 0.0, 0.0])), rotate(palm[3:], _UP)
    middle = palm[:3] + radius * out + np.array([_INTO_FINGERS, 0.0, 0.0])
    return closed(skeleton, side, Cylinder(middle, thumb, radius))


def _targets(clip: Clip, table: Table, skeleton: Skeleton, time: Array) -> Array | None:
    """Targets (F, 5, 8) relative to the site; None where the table has none and the clip had none."""
    if not table.hand and not table.gaze:
        return clip.targets
    targets = np.zeros((clip.frames, 5, 8)) if clip.targets is None else clip.targets.copy()
    palms = grips(skeleton, clip.rotations, clip.root)
    back = from_axis_angle(_UP, -np.radians(table.site.facing_deg))
    for row in table.hand:
        _on_site(targets[:, _ROWS[row.hand]], palms[:, _ROWS[row.hand]], back, row, time)
    for row in table.gaze:
        share = row.weight * _share(row, time, row.ease)
        looking = share > targets[:, GAZE, 7]
        place = np.array(row.at) if row.on is None else targets[:, _ROWS[row.on], :3]
        targets[:, GAZE, :3] = np.where(looking[:, None], place, targets[:, GAZE, :3])
        targets[:, GAZE, 7] = np.maximum(targets[:, GAZE, 7], share)
    return targets


def _on_site(target: Array, palms: Array, back: Array, row: Grip, time: Array) -> None:
    """A hand's target (F, 8): the path of its palm (F, 7), moved as a whole so that it meets the site in time."""
    met = min(round(row.begin * (len(time) - 1) / max(float(time[-1]), 1e-9)), len(time) - 1)
    target[:, :3] = np.array(row.at) + rotate(back, palms[:, :3] - palms[met, :3])
    target[:, 3:7] = multiply(back, palms[:, 3:])
    target[:, 7] = _share(row, time, row.ease)


def _relative(clip: Clip, where: Whereabouts) -> Clip:
    """The clip relative to the object's frame."""
    turn = from_axis_angle(_UP, np.radians(where.facing_deg))
    frame = min(round(where.at * clip.rate), clip.frames - 1)
    rotations, root = clip.rotations.copy(), rotate(conjugate(turn), clip.root)
    rotations[:, 0] = multiply(conjugate(turn), rotations[:, 0])
    root[:, :2] += np.array(where.hips) - root[frame, :2]
    return replace(clip, rotations=rotations, root=root, header=msgspec.structs.replace(clip.header, frame="object"))
