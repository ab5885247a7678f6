"""Whether there is room where a captured motion puts down what both hands hold: there, and on the way down to it.

The motion says where its hands go, so it is known before it begins where what they hold comes to stand.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import shapely

from ahmss.body.array import Array
from ahmss.body.quaternion import about_z, rotate
from ahmss.database.workspace import Workspace
from ahmss.errors import AhmssError, CommandError
from ahmss.main.afforded import Actor
from ahmss.main.description import Scene
from ahmss.main.occupied import FLAT, TOUCHES, outlines
from ahmss.motion import clip as clips

__all__ = ["laid", "refuse_no_room"]

_HELD = 0.9  # weight of a hand's target from which on it holds
_BACK, _STEP = 1.2, 0.05  # metres that one steps back for it at the most; between the places that are tried
_APART = 0.03  # metres from what stands about, where one is told to step


def laid(motion: Path, pose: Array) -> Array:
    """Where (3,) what is in a pose (7,) between both hands comes to be by a motion's clip, whose hands leave it there.

    Raises:
        DataError: the clip is missing or broken.
    """
    targets = clips.load(motion).targets
    held = np.zeros(0, int) if targets is None else np.flatnonzero(targets[:, :2, 7].min(axis=-1) > _HELD)
    if targets is None or not len(held):
        return pose[:3].copy()
    moved = (targets[held[-1], :2, :3] - targets[held[0], :2, :3]).mean(axis=0)
    return pose[:3] + rotate(about_z(pose[3:]), moved)


def refuse_no_room(workspace: Workspace, scene: Scene, title: str, held: str, place: Array, actor: Actor) -> None:
    """Refuse to put a thing down where it would come into another; a kind whose shape can't be had is in nothing's way.

    Args:
        title: of the action. held: the thing's name. place: (3,) where its origin is to be. actor: who puts it down.

    Raises:
        CommandError: names what is there, and from where there is room, where stepping back helps.
    """
    try:
        shape = workspace.objects.shape(scene.objects[held].kind)
    except AhmssError:
        return
    if shape is None:
        return
    low, high = np.array(shape.bounds)
    pose = scene.pose(held)
    turn = about_z(pose[3:])
    corners = np.array([[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]])
    around = shapely.Polygon((rotate(turn, np.pad(corners, ((0, 0), (0, 1)))) + place)[:, :2])
    bottom, top = place[2] + low[2] + FLAT, pose[2] + high[2]
    there = dict(outlines(workspace, scene, held, lambda _, lowest, highest: lowest < top and highest > bottom))
    inside = [name for name, ring in there.items() if shapely.intersects(ring, shapely.buffer(around, -TOUCHES))]
    if not inside:
        return
    ahead = rotate(turn, np.array([1.0, 0.0, 0.0]))[:2]
    for far in np.arange(_STEP, _BACK, _STEP).tolist():
        moved = shapely.transform(around, lambda points, far=far: points - far * ahead)
        if all(shapely.distance(ring, moved) >= _APART for ring in there.values()):
            x, y = (actor.root[:2] - far * ahead).tolist()
            facing = np.degrees(np.arctan2(ahead[1], ahead[0]))
            there_is = f"step back first, `do floor walk to {x:.2f} {y:.2f} facing {facing:.0f}`"
            raise CommandError(f"{title}: {inside[0]} stands there; {there_is}")
    raise CommandError(f"{title}: {inside[0]} stands there; put it down elsewhere, or move that first")
