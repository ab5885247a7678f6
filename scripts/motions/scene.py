"""Where things are for the motions: the room's objects as a human sees them that stands as in examples/table.txt."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ahmss.algorithm import Transform, resolve_site
from ahmss.algorithm.messages import SiteRecord
from ahmss.body.quaternion import from_axis_angle
from ahmss.database import Workspace

__all__ = ["HEADING", "Scene"]

HEADING = -20.0  # degrees: between the table ahead and the door to the right
_AT = (0.0, 0.0, 0.0)  # where the human stands in the room
_UP = np.array([0.0, 0.0, 1.0])


@dataclass(frozen=True)
class Scene:
    """Frames in the stance frame of the human: cup (its side, x away from the human), rim, knob (door closed), hinge,
    screen. cup_radius and lever_radius in metres."""

    cup: Transform
    rim: Transform
    knob: Transform
    hinge: Transform
    screen: Transform
    cup_radius: float
    lever_radius: float

    @classmethod
    def of(cls, workspace: Workspace) -> Scene:
        """The scene of the room in objectdb/."""
        stance = Transform(np.array(_AT), from_axis_angle(_UP, np.radians(HEADING))).inverse()
        placed = {p.name: p for p in workspace.objects.place("room", "room")}
        kinds = {name: workspace.objects.get(p.kind) for name, p in placed.items()}

        def frame(name: str) -> Transform:
            return stance.then(Transform(np.array(placed[name].position), np.array(placed[name].rotation)))

        def site(name: str, key: str) -> Transform:
            record = kinds[name].sites[key]
            axis = "z" if record.free_axis == "z" else ""
            return resolve_site(frame(name), SiteRecord(record.position, record.rotation, axis), np.zeros(3))

        door = next(name for name, p in placed.items() if p.kind == "door")
        return cls(
            cup=site("room/cup", "wall"), rim=site("room/cup", "rim"), knob=site(door, "knob"), hinge=frame(door),
            screen=site("room/television", "screen"),
            cup_radius=0.5 * float(kinds["room/cup"].properties["diameter"]),
            lever_radius=float(0.5 * kinds[door].properties["knob_diameter"]),
        )  # fmt: skip
