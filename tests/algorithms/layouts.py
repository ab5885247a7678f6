"""Panels as START messages tell them: controls placed and tilted at random, and what a hand did to one of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from ahmss.algorithm import HumanPose, Transform, WorldObject, frames
from ahmss.algorithm.messages import ObjectRecord, PoseRecord, ShapeRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.inverse import solve
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, fingers
from ahmss.body.quaternion import from_axis_angle, multiply, rotate
from ahmss.grasping.hand import Hand
from ahmss.skills.box import Box, boxes_of
from ahmss.skills.controls import front_of

from .reached import outlined
from .scene import WORKSPACE, Body, program
from .touching import pads, skins

COUNT, APART = 40, 0.13  # controls of a layout; metres between their middles
KINDS = ("push_button", "latching_button")
Y, UP = np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Control:
    """A control that stands somewhere in the world."""

    number: int
    kind: str
    frame: Transform

    def site(self, name: str) -> Transform:
        site = WORKSPACE.objects.get(self.kind).sites[name]
        return self.frame.then(Transform(np.array(site.position), np.array(site.rotation)))

    def boxes(self) -> list[Box]:
        return boxes_of(WorldObject.of(self.record()))

    def record(self, states: dict[str, Any] | None = None, *, shaped: bool = False) -> ObjectRecord:
        kind = WORKSPACE.objects.get(self.kind)
        sites = {
            key: SiteRecord(site.position, site.rotation, "z" if site.free_axis else "", site.grip)  # type: ignore[arg-type]
            for key, site in kind.sites.items()
        }
        kept = WORKSPACE.objects.kept_shape(self.kind) if shaped else None
        told = ObjectRecord(
            self.number, f"panel/{self.kind}_{self.number}", self.kind, tuple(self.frame.place.tolist()),
            tuple(self.frame.rotation.tolist()), sites, kind.properties, kind.initial_states | (states or {}),
            shape=ShapeRecord(str(kept[0]), kept[1]) if kept is not None else None,
        )  # fmt: skip
        return outlined(told, self.number)


@dataclass(frozen=True)
class Layout:
    """Controls that stand about, and somebody before one of them."""

    controls: tuple[Control, ...]

    @classmethod
    def drawn(cls, seed: int, kinds: tuple[str, ...] = KINDS) -> Layout:
        """40 controls on a surface 2 m wide that is anywhere: 0.7 to 1.5 m high, tilted from flat to upright."""
        random = np.random.default_rng(seed)
        at = Transform(np.append(random.uniform(-3.0, 3.0, 2), 0.0), about_z(random.uniform(-np.pi, np.pi)))
        places: list[Array] = []
        while len(places) < COUNT:
            height = random.uniform(0.7, 1.5)
            place = np.array([-0.35 * (height - 0.7) + random.uniform(-0.05, 0.05), random.uniform(-1.0, 1.0), height])
            if all(np.linalg.norm(place - other) > APART for other in places):
                places.append(place)
        controls: list[Control] = []
        for number, place in enumerate(places, 1):
            slope, aside = random.uniform(0.0, 90.0), random.uniform(-20.0, 20.0)
            turn = multiply(about_z(np.radians(aside)), from_axis_angle(Y, np.radians(slope - 90.0)))
            kind = kinds[int(random.integers(len(kinds)))]
            controls.append(Control(number, kind, at.then(Transform(place, turn))))
        return cls(tuple(controls))

    def others(self, control: Control) -> list[Box]:
        """What all but one of them fill."""
        return [box for other in self.controls if other is not control for box in other.boxes()]

    def start(
        self, control: Control, body: Body, action: str, states: dict[str, Any] | None = None, **given: Any
    ) -> Start:
        """START of an action of a control, as main tells it."""
        affordance = WORKSPACE.objects.get(control.kind).affordances[action]
        entry = WORKSPACE.algorithms.find(affordance.human_algorithm)
        fields: dict[str, Any] = {
            "frames": 0, "wish": True, "site": affordance.site or "",
            "motion": str(affordance.motion) if affordance.motion else None,
            "parameters": {k: v for k, v in affordance.parameters.items() if k in entry.parameters},
            "world": [other.record() for other in self.controls if other is not control],
        }  # fmt: skip
        return Start(
            kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root),
            object=control.record(states, shaped=entry.shape), **(fields | given),
        )  # fmt: skip


def somebody(name: str, control: Control, seed: int, most: float = 1.5) -> Body:
    """A human somewhere before a control, who looks about where it is."""
    random = np.random.default_rng(seed)
    front = front_of(control.frame)
    angle = np.arctan2(front[1], front[0]) + random.uniform(-0.6, 0.6)
    place = control.frame.place[:2] + random.uniform(0.55, most) * np.array([np.cos(angle), np.sin(angle)])
    return Body(name, float(place[0]), float(place[1]), float(np.degrees(angle)) + 180.0 + random.uniform(-40.0, 40.0))


def used(body: Body, start: Start, algorithm: str | Callable[[Any], Any]) -> Used:
    """What is shown of a motion, joints that it leaves alone being as they were a frame before."""
    shown: list[HumanPose] = []
    for pose in frames(program(algorithm) if isinstance(algorithm, str) else algorithm, start):
        driven = pose.importance > 0.0
        rotations = np.where(driven[:43, None], pose.rotations, body.rotations)
        root = pose.root if driven[43] else body.root
        body.rotations, body.root = solve(body.skeleton, rotations, root, pose.targets), root
        shown.append(HumanPose(body.rotations, body.root, pose.importance, pose.targets))
    return Used(body, shown)


@dataclass(frozen=True)
class Used:
    """The frames in which a control was used, as they are shown, and what there is to measure on them."""

    body: Body
    shown: list[HumanPose]

    @property
    def side(self) -> str:
        return ("right", "left")[int(np.array([pose.targets[:2, 7] for pose in self.shown]).sum(axis=0).argmax())]

    def _placed(self) -> tuple[Array, Array]:
        rotations, root = np.array([p.rotations for p in self.shown]), np.array([p.root for p in self.shown])
        return forward(rotations, root, self.body.skeleton.offsets)

    def tip(self, finger: str, side: str = "") -> Array:
        """The tip of a finger (F, 3)."""
        places, turned = self._placed()
        link = INDEX[f"{side or self.side}_{finger}_distal"]
        return places[:, link] + rotate(turned[:, link], self.body.skeleton.tips[link])

    def pad(self, site: Transform) -> Array:
        """The pad (F, 3) of the index finger of the hand that acts, in the frame of a site that it pushes."""
        into = -rotate(site.rotation, np.array([1.0, 0.0, 0.0]))
        return site.inverse().apply(pads(self.body, self.shown, self.side, into))

    def skin(self, site: Transform) -> Array:
        """Where the skin (F, 3) of that finger is furthest."""
        into = -rotate(site.rotation, np.array([1.0, 0.0, 0.0]))
        return site.inverse().apply(skins(self.body, self.shown, self.side, into))

    def hands(self) -> Array:
        """Points of both hands and their fingers (F, n, 3)."""
        places, turned = self._placed()
        links = [INDEX[f"{side}_hand"] for side in ("right", "left")] + list(fingers("right")) + list(fingers("left"))
        ends = places[:, links] + rotate(turned[:, links], self.body.skeleton.tips[links])
        return np.concatenate([places[:, links], 0.5 * (places[:, links] + ends), ends], axis=1)

    def clear(self, boxes: list[Box]) -> float:
        """Metres between the skin of the fingers that act and any of these boxes; negative within."""
        hand, (places, turned) = Hand.of(self.body.skeleton, self.side), self._placed()
        middles, radii = hand.balls(np.array([pose.rotations[list(fingers(self.side))] for pose in self.shown]))
        wrist, turn = (of[:, INDEX[f"{self.side}_hand"], None, None] for of in (places, turned))
        points = (wrist + rotate(turn, middles)).reshape(-1, radii.size, 3)
        return min(float((box.gap(points) - radii.ravel()).min()) for box in boxes)

    def nearest(self, boxes: Iterator[Box] | list[Box]) -> float:
        """Metres between any point of the hands and any of these boxes; negative within."""
        points = self.hands()
        return min((float(box.gap(points).min()) for box in boxes), default=np.inf)


def about_z(angle: float) -> Array:
    return from_axis_angle(UP, np.array(angle))
