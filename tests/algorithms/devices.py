"""Devices of objectdb/ set up anywhere, for the tests of what is done with them."""

from __future__ import annotations

from typing import Any

import numpy as np

from ahmss.algorithm import HumanPose, Transform
from ahmss.algorithm.messages import ObjectRecord, PoseRecord, ShapeRecord, SiteRecord, Start
from ahmss.body.array import Array
from ahmss.body.kinematics import forward
from ahmss.body.links import INDEX
from ahmss.body.quaternion import from_axis_angle, rotate

from .reached import outlined
from .scene import WORKSPACE, Body

UP = np.array([0.0, 0.0, 1.0])
SIDES = ("right", "left")


def device(kind: str, frame: Transform, states: dict[str, Any] | None = None, *, shaped: bool = False) -> ObjectRecord:
    """An object of a kind at a frame."""
    known = WORKSPACE.objects.get(kind)
    sites = {
        key: SiteRecord(site.position, site.rotation, "z" if site.free_axis else "", site.grip)  # type: ignore[arg-type]
        for key, site in known.sites.items()
    }
    kept = WORKSPACE.objects.kept_shape(kind) if shaped else None
    told = ObjectRecord(
        3, kind, kind, tuple(frame.place.tolist()), tuple(frame.rotation.tolist()), sites, known.properties,
        known.initial_states | (states or {}), shape=ShapeRecord(str(kept[0]), kept[1]) if kept is not None else None,
    )  # fmt: skip
    return outlined(told, 3)


def begun(body: Body, thing: ObjectRecord | None, site: str, parameters: dict[str, Any], **given: Any) -> Start:
    """START of a human algorithm."""
    return Start(
        kind="human", human=body.skeleton.to_record(), pose=PoseRecord.of(body.rotations, body.root), object=thing,
        site=site, parameters=parameters, **({"frames": 0, "wish": True} | given),
    )  # fmt: skip


def mover(body: Body, start: Start, parameters: dict[str, Any] | None = None) -> Start:
    """START of the object algorithm that goes with it; the body as it was before."""
    return Start(
        kind="object", human=start.human, pose=start.pose, object=start.object, site=start.site, frames=start.frames,
        parameters=parameters or {}, hand=start.hand, hold=start.hold,
    )  # fmt: skip


def before(name: str, frame: Transform, away: float, aside: float = 0.0, turn: float = 0.0) -> Body:
    """A human who stands before a thing that faces along its x, so far away, turned aside by degrees."""
    place = frame.apply(np.array([away, aside, 0.0]))
    out = rotate(frame.rotation, np.array([1.0, 0.0, 0.0]))
    return Body(name, float(place[0]), float(place[1]), float(np.degrees(np.arctan2(-out[1], -out[0]))) + turn)


def at(x: float, y: float, z: float, turn: float = 0.0) -> Transform:
    """A frame turned about z by radians."""
    return Transform(np.array([x, y, z]), from_axis_angle(UP, turn))


def posed(body: Body, shown: list[HumanPose]) -> tuple[Array, Array]:
    """Places (F, 43, 3) and rotations (F, 43, 4) of all links in the world."""
    rotations, root = np.array([p.rotations for p in shown]), np.array([p.root for p in shown])
    return forward(rotations, root, body.skeleton.offsets)


def tips(body: Body, shown: list[HumanPose], side: str, finger: str = "index") -> Array:
    """Where a fingertip is (F, 3)."""
    link = INDEX[f"{side}_{finger}_distal"]
    places, turned = posed(body, shown)
    return places[:, link] + rotate(turned[:, link], body.skeleton.tips[link])


def acting(shown: list[HumanPose]) -> str:
    """The hand that does it."""
    return SIDES[int(np.array([pose.targets[:2, 7] for pose in shown]).sum(axis=0).argmax())]
