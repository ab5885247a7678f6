"""Places in the world as an algorithm sees them: frames, objects, and their sites."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Hashable
from dataclasses import dataclass, field
from typing import Any, TypeVar, cast

import numpy as np

from ahmss.algorithm.messages import ObjectRecord, SiteRecord
from ahmss.algorithm.shape import TargetShape
from ahmss.body.array import Array
from ahmss.body.quaternion import about_z, conjugate, from_axis_angle, multiply, rotate

__all__ = ["Transform", "WorldObject", "resolve_site"]

Value = TypeVar("Value")


@dataclass(frozen=True)
class Transform:
    """A frame in a parent's: place (..., 3) in metres and rotation (..., 4), unit, parent <- frame."""

    place: Array
    rotation: Array

    @classmethod
    def of(cls, row: Array) -> Transform:
        """From rows (..., 7): place, then quaternion."""
        return cls(row[..., :3], row[..., 3:7])

    def row(self) -> Array:
        """Rows (..., 7): place, then quaternion."""
        return np.concatenate([self.place, self.rotation], axis=-1)

    def apply(self, points: Array) -> Array:
        """Points (..., 3) of this frame in the parent's coordinates."""
        return self.place + rotate(self.rotation, points)

    def then(self, inner: Transform) -> Transform:
        """The frame `inner`, given in this one, in the parent's coordinates."""
        return Transform(self.apply(inner.place), multiply(self.rotation, inner.rotation))

    def inverse(self) -> Transform:
        """The parent in this frame."""
        back = conjugate(self.rotation)
        return Transform(-rotate(back, self.place), back)


_SEEN = 70  # frames: a stride and a little


def _sightings() -> deque[tuple[float, float, float, float]]:
    return deque(maxlen=_SEEN)


@dataclass
class WorldObject:
    """An object of the world. `place` (3,) and `rotation` (4,) follow it where the algorithm asked for the world.

    footprint: outlines (n, 2) of the area on the floor that it occupies for a walker, in its frame turned about z
    only, counter-clockwise, without holes; empty where algorithm.toml does not ask for `footprints`, and for what is
    under 5 cm, over 1.9 m, or in the hands of the acting human. seen: of a human, the last frames in which it moved:
    the frame, x and y, and which way they faced, radians. moved: of a human, where sites that move by themselves are
    in the world, by their ids. way: of a human, where they mean to be, (6, 2) metres at the seconds of
    `ahmss.motion.way.AHEAD` from now; None where they tell none, or algorithm.toml does not ask for `ways`. heard: the
    last frame in which anything was told of a human.
    shape: of the target, where algorithm.toml asks for `shape` and it has one, and of what else has a footprint where
    it asks for `shapes`; read when first looked at.
    """

    id: int
    name: str
    kind: str
    place: Array
    rotation: Array
    sites: dict[str, SiteRecord] = field(default_factory=dict[str, SiteRecord])
    properties: dict[str, Any] = field(default_factory=dict[str, Any])
    states: dict[str, Any] = field(default_factory=dict[str, Any])
    footprint: tuple[Array, ...] = ()
    shape: TargetShape | None = field(default=None, compare=False)
    seen: deque[tuple[float, float, float, float]] = field(default_factory=_sightings, repr=False, compare=False)
    moved: dict[int, Transform] = field(default_factory=dict[int, Transform], repr=False, compare=False)
    way: Array | None = field(default=None, repr=False, compare=False)
    heard: int = field(default=0, repr=False, compare=False)
    _stays: tuple[bytes, dict[Hashable, Any]] = field(default=(b"", {}), init=False, repr=False, compare=False)

    def while_it_stays(self, key: Hashable, make: Callable[[], Value]) -> Value:
        """What `make` gives, kept under `key` for as long as the object is where it is."""
        at = self.place.tobytes() + self.rotation.tobytes()
        if self._stays[0] != at:
            self._stays = at, {}
        kept = self._stays[1]
        if key not in kept:
            kept[key] = make()
        return cast(Value, kept[key])

    @classmethod
    def of(cls, record: ObjectRecord) -> WorldObject:
        """The object of a START record."""
        return cls(
            record.id, record.name, record.kind, np.array(record.place), np.array(record.rotation),
            record.sites, record.properties, dict(record.states), tuple(np.array(ring) for ring in record.footprint),
            TargetShape(record.shape.path, record.shape.hash) if record.shape is not None else None,
            way=np.array(record.way) if record.way is not None else None,
        )  # fmt: skip

    @property
    def frame(self) -> Transform:
        """The object's frame in the world as it is now; it stays so where the object moves on."""
        return Transform(self.place.copy(), self.rotation.copy())

    @property
    def occupied(self) -> tuple[Array, ...]:
        """The footprint where the object is now: outlines (n, 2) in the world."""
        w, _, _, z = about_z(self.rotation)
        cos, sin = w * w - z * z, 2.0 * w * z
        turn = np.array([[cos, sin], [-sin, cos]])  # of rows
        return tuple(self.place[:2] + ring @ turn for ring in self.footprint)

    def site(self, name: str, human: Array) -> Transform:
        """A site in the world, its free axis turned away from a human whose root is at `human` (3,).

        Raises:
            KeyError: the object has no such site; the message lists those that it has.
        """
        if name not in self.sites:
            raise KeyError(f"{self.name} has no site {name!r}; it has: {', '.join(self.sites) or 'none'}")
        site = self.sites[name]
        return self.moved.get(site.id) or resolve_site(self.frame, site, human)


def resolve_site(frame: Transform, site: SiteRecord, human: Array) -> Transform:
    """A site in the world; with free_axis "z" its x points away from the human, at right angles to its own z.

    Args:
        frame: the object in the world.
        site: in the object's frame.
        human: (3,) place of the acting human's root.
    """
    fixed = frame.then(Transform(np.array(site.position), np.array(site.rotation)))
    if site.free_axis != "z":
        return fixed
    away = rotate(conjugate(fixed.rotation), (fixed.place - human) * np.array([1.0, 1.0, 0.0]))
    if np.hypot(away[0], away[1]) < 1e-6:  # the human is on the axis: any yaw serves
        return fixed
    yaw = from_axis_angle(np.array([0.0, 0.0, 1.0]), float(np.arctan2(away[1], away[0])))
    return Transform(fixed.place, multiply(fixed.rotation, yaw))
