"""Reaches of the shipped algorithm in seeded scenes: a cup on a table, both anywhere and turned, a human before it."""

from __future__ import annotations

import copy
from dataclasses import dataclass, replace
from typing import Any

import msgspec
import numpy as np
from scipy.spatial import ConvexHull

from ahmss.algorithm import HumanPose, Transform, WorldObject
from ahmss.algorithm.messages import ObjectRecord, Start
from ahmss.body.arm import Arm, excess
from ahmss.body.array import Array
from ahmss.body.inverse import grips
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX, LINKS
from ahmss.body.quaternion import conjugate, from_axis_angle, multiply, rotate, to_rotation_vector
from ahmss.body.skeleton import Skeleton
from ahmss.motion.contact import foot_points
from ahmss.reaching.prism import Prism
from ahmss.reaching.standing import centre_of_mass

from .scene import CUP, WORKSPACE, Body, record

UP = np.array([0.0, 0.0, 1.0])
RATE = 60.0
TABLE = "room/table"
HALF = np.array([0.5, 0.6])  # metres, of the table's top
UNDERSIDE = 0.85  # metres, of its top
WRIST = 0.72  # of a forearm's thickness
ARMS = np.array(
    [i >= 15 or link.endswith(("lower_arm", "hand")) for i, link in enumerate(LINKS)]
)  # forearms, hands, fingers


@dataclass(frozen=True)
class Scene:
    """A table with a cup on it, and where a human stands."""

    body: Body
    table: Transform
    cup: Transform

    @classmethod
    def drawn(cls, seed: int) -> Scene:
        """Both humans in turn; the cup up to 0.33 m behind any edge of the table, the human close before that edge.

        No hand is in the table's top already; some hang under it.
        """
        random = np.random.default_rng(seed)
        name = ("ken", "aiko")[seed % 2]
        table = Transform(np.append(random.uniform(-2.0, 2.0, 2), 0.0), _about_z(random.uniform(-np.pi, np.pi)))
        edge, sign = int(random.integers(2)), (-1.0, 1.0)[int(random.integers(2))]
        into, along = random.uniform(0.04, 0.33), random.uniform(-0.45, 0.45)
        before, aside = random.uniform(0.17, 0.34), random.uniform(-0.3, 0.3)
        on, stands = np.array([0.0, 0.0, 0.88]), np.zeros(3)
        on[edge], on[1 - edge] = sign * (HALF[edge] - into), along
        stands[edge], stands[1 - edge] = sign * (HALF[edge] + before), along + aside
        cup = table.then(Transform(on, _about_z(random.uniform(-np.pi, np.pi))))
        stands = table.apply(stands)
        toward = np.degrees(np.arctan2(*(cup.place - stands)[1::-1]))
        facing = toward + random.uniform(-40.0, 40.0)
        made = cls(Body(name, float(stands[0]), float(stands[1]), float(facing)), table, cup)
        standing = HumanPose(made.body.rotations, made.body.root)
        if Reached(made, made.body.skeleton, [standing]).depth_in_top()[0] > 0.0:
            return cls.drawn(seed + 1000)
        return made

    def start(self, **given: Any) -> Start:
        """START of reaching for the cup."""
        fields = {"frames": 0, "wish": True, "hand": "", "motion": None, "parameters": {}, "site": "wall"}
        start = self.body.start(CUP, "reach", frame=self.cup, **(fields | given))
        others = [outlined(record(TABLE, self.table), 11)]
        return msgspec.structs.replace(start, object=outlined(start.object, 3), world=others)

    def reach(self, **given: Any) -> Reached:
        """Played to the end."""
        moved = copy.copy(self.body)
        return Reached(self, moved.skeleton, moved.do("reach", self.start(**given)))


@dataclass(frozen=True)
class Reached:
    """The frames as they are shown, and what there is to measure on them."""

    scene: Scene
    skeleton: Skeleton
    shown: list[HumanPose]

    @property
    def rotations(self) -> Array:
        return np.array([pose.rotations for pose in self.shown])

    @property
    def root(self) -> Array:
        return np.array([pose.root for pose in self.shown])

    @property
    def row(self) -> int:
        """0: the right hand reaches, 1: the left."""
        return int(np.array([pose.targets[:2, 7] for pose in self.shown]).sum(axis=0).argmax())

    @property
    def side(self) -> str:
        return ("right", "left")[self.row]

    def palm(self, frame: int = -1) -> Transform:
        return Transform.of(grips(self.skeleton, self.rotations[frame], self.root[frame])[self.row])

    def off_site(self, before: float = 0.066) -> tuple[float, float]:
        """Metres and degrees by which the palm is off the cup's wall: so far before its axis, upright, facing it."""
        palm, site = self.palm(), self.scene.cup.apply(np.array([0.0, 0.0, 0.052]))
        out = rotate(palm.rotation, np.array([1.0, 0.0, 0.0]))
        apart = float(np.linalg.norm(palm.place + before * out - site))
        up = rotate(palm.rotation, UP)
        return apart, float(np.degrees(np.arccos(np.clip(up @ rotate(self.scene.cup.rotation, UP), -1.0, 1.0))))

    def off_target(self) -> tuple[float, float]:
        """Metres and degrees between the palm and its target at the end."""
        palm, target = self.palm(), self.shown[-1].targets[self.row]
        turned = to_rotation_vector(multiply(conjugate(target[3:7]), palm.rotation))
        return float(np.linalg.norm(palm.place - target[:3])), float(np.degrees(np.linalg.norm(turned)))

    def depth_in_top(self) -> tuple[float, str]:
        """How deep skin of arms and hands, and bones of all else, are in the table's top at the most, metres; what."""
        places, turned = forward(self.rotations, self.root, self.skeleton.offsets)
        tips = places + rotate(turned, np.broadcast_to(self.skeleton.tips, places.shape))
        along = np.linspace(0.0, 1.0, 5)[:, None, None, None]
        points = places + along * (tips - places)
        deepest, name = -np.inf, ""
        radii = np.repeat(np.where(ARMS, self.skeleton.radii, 0.0)[None], 5, axis=0)
        radii[-1, [INDEX["right_lower_arm"], INDEX["left_lower_arm"]]] *= WRIST
        for prism in prisms(record(TABLE, self.scene.table)):
            gap = replace(prism, low=UNDERSIDE).signed(points)
            depth = (radii[:, None] - gap).max(axis=0)
            link = int(depth.max(axis=0).argmax())
            if depth.max() > deepest:
                deepest, name = float(depth.max()), LINKS[link]
        return deepest, name

    def out_of_balance(self) -> float:
        """Metres by which the centre of mass is beyond the feet, seen from above, at the most; negative within."""
        centre = centre_of_mass(self.skeleton, self.rotations, self.root)[:, :2]
        points = foot_points(self.skeleton, self.rotations[:1], self.root[:1])[0].reshape(-1, 3)[:, :2]
        hull = ConvexHull(points).equations
        return float((centre @ hull[:, :2].T + hull[:, 2]).max())

    def foot_slide(self) -> float:
        return float(np.ptp(foot_points(self.skeleton, self.rotations, self.root), axis=0).max())

    def beyond_limits(self) -> float:
        """Degrees by which the reaching arm is beyond its limits at the most, after the first tenth."""
        arm, first = Arm.of(self.skeleton, self.side), INDEX[f"{self.side}_upper_arm"]
        links = arm.from_pose(self.rotations[:, first : first + 3])
        return float(np.degrees(excess(arm, links)[len(links) // 10 :].max()))

    def fastest(self, link: str) -> float:
        """Metres a second, at the most, of the joint that the reaching side's "lower_arm" or "hand" begins with."""
        places, _ = forward(self.rotations, self.root, self.skeleton.offsets)
        steps = np.diff(places[:, INDEX[f"{self.side}_{link}"]], axis=0)
        return float(np.linalg.norm(steps, axis=-1).max() * RATE)

    def peak(self) -> float:
        """How many times as fast as in the mean of its way the wrist is at the most."""
        places, _ = forward(self.rotations, self.root, self.skeleton.offsets)
        steps = np.linalg.norm(np.diff(places[:, INDEX[f"{self.side}_hand"]], axis=0), axis=-1)
        return float(steps.max() / steps[steps > 1e-4].mean())

    def largest_step(self) -> float:
        """Degrees that any joint turns from one frame to the next at the most, the head's and the first frame's not."""
        steps = multiply(conjugate(self.rotations[:-1]), self.rotations[1:])
        angles = np.degrees(np.linalg.norm(to_rotation_vector(steps), axis=-1))
        return float(np.delete(angles, INDEX["head"], axis=1).max())


def outlined(told: ObjectRecord, number: int) -> ObjectRecord:
    """A record with the footprint that `footprints = true` asks for."""
    rings = WORKSPACE.objects.footprint(told.kind, told.place[2], np.array(told.rotation))
    return msgspec.structs.replace(told, id=number, footprint=[list(ring) for ring in rings])


def prisms(told: ObjectRecord) -> list[Prism]:
    """The blocks of an object that has a size."""
    thing = WorldObject.of(outlined(told, 1))
    return [Prism(ring, told.place[2], told.place[2] + told.properties["size"][2]) for ring in thing.occupied]


def _about_z(angle: float) -> Array:
    return from_axis_angle(UP, angle)
