"""Made-up motions of a human to be measured: standing, with something wrong with it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from ahmss.bench.acted import Acted, Thing
from ahmss.bench.depth import Depth, under_floor
from ahmss.bench.measures import Measured, Series
from ahmss.bench.survey import Doing, Span
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.quaternion import IDENTITY
from ahmss.body.skeleton import Skeleton

ROOT = Path(__file__).resolve().parents[2]
RATE = 60.0
FRAMES = 120
KEN = Skeleton.of(1.76, "male", "ken")
WALK = Doing("floor", "walk", carries=True)


def standing(frames: int = FRAMES, doing: Doing | None = None) -> Acted:
    """Somebody who stands and moves nothing."""
    pose, place = KEN.relaxed()
    rotations, root = np.repeat(pose[None], frames, axis=0), np.repeat(place[None], frames, axis=0)
    doings = ((doing,) if doing else (),) * frames
    nowhere = np.full((frames, 2, 7), np.nan)
    return Acted("ken", "ken", KEN, RATE, rotations, root, doings, nowhere, np.zeros((frames, 2), np.int64))


def moved(acted: Acted, way: Array) -> Acted:
    """The same with the whole body displaced by (F, 3)."""
    return replace(acted, root=acted.root + way)


def stepping(acted: Acted, far: float) -> Acted:
    """In the middle fifth the body comes off the floor, goes so many metres along x and comes down again."""
    share = np.clip((np.arange(len(acted.root)) / len(acted.root) - 0.4) / 0.2, 0.0, 1.0)
    return moved(acted, np.outer(share, [far, 0.0, 0.0]) + np.outer(np.sin(np.pi * share), [0.0, 0.0, 0.05]))


def along_x(acted: Acted, speed: float) -> Array:
    """Displacements (F, 3) of who glides at so many metres a second."""
    return np.outer(np.arange(len(acted.root)) * speed / acted.rate, [1.0, 0.0, 0.0])


def palms(acted: Acted) -> Array:
    """(F, 2, 7)."""
    return grips(acted.skeleton, acted.rotations, acted.root)


def wanting(acted: Acted, off: Array, first: int = 30, hand: int = 0) -> Acted:
    """One motion wants a palm from a frame on, (3,) or (F, 3) off where it is."""
    wanted, owner = acted.wanted.copy(), acted.owner.copy()
    wanted[first:, hand] = palms(acted)[first:, hand]
    wanted[:, hand, :3] += off
    owner[first:, hand] = 4
    return replace(acted, wanted=wanted, owner=owner)


def holding(acted: Acted, slip: Array, hand: str = "right") -> Acted:
    """A cup goes along with the right palm of who glides, (F, 3) off where it was taken."""
    poses = palms(acted)[:, 0].copy()
    poses[:, :3] += slip
    frames = len(poses)
    thing = Thing("cup", poses, ("ken",) * frames, (hand,) * frames, ({},) * frames)
    return replace(acted, things={"cup": thing})


def placed(acted: Acted, kind: str, place: tuple[float, float, float], **states: object) -> Acted:
    """With a thing that stands somewhere."""
    pose = np.concatenate([place, IDENTITY])
    frames = len(acted.root)
    thing = Thing(kind, np.repeat(pose[None], frames, axis=0), ("",) * frames, ("",) * frames, (states,) * frames)
    return replace(acted, things={**acted.things, kind: thing})


def measured(acted: Acted, span: Span | None = None) -> Measured:
    """All but what goes through things."""
    frames = len(acted.root)
    nothing = Depth(np.zeros(frames), ("",) * frames, ("",) * frames)
    return Series(acted, nothing, under_floor(acted)).over(span or Span(0, frames))
