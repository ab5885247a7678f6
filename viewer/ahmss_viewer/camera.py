"""The camera: it orbits a target; z is up."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
import pyrender

from ahmss.body.array import Array

__all__ = ["View", "look_at", "project"]

_NEAR, _FAR = 0.05, 80.0
_STEEPEST = np.radians(89.0)


@dataclass(frozen=True)
class View:
    """A camera at `distance` metres from `target`, seen from azimuth (0: the camera is on the +x side) and elevation.

    Angles in radians; `field_of_view` is vertical.
    """

    target: Array = field(default_factory=lambda: np.array([0.0, 0.0, 0.9]))
    distance: float = 4.0
    azimuth: float = 0.7
    elevation: float = 0.3
    field_of_view: float = np.radians(42.0)

    def pose(self) -> Array:
        """T_world_camera (4, 4), OpenGL's way: the camera looks along its -z, y up."""
        ca, sa = np.cos(self.azimuth), np.sin(self.azimuth)
        ce, se = np.cos(self.elevation), np.sin(self.elevation)
        back = np.array([ca * ce, sa * ce, se])
        right = np.array([-sa, ca, 0.0])
        T = np.eye(4)
        T[:3, 0], T[:3, 1], T[:3, 2] = right, np.cross(back, right), back
        T[:3, 3] = self.target + self.distance * back
        return T

    def projection(self, aspect: float) -> Array:
        """From the camera's frame to clip space (4, 4); aspect is width / height."""
        camera = pyrender.PerspectiveCamera(yfov=self.field_of_view, znear=_NEAR, zfar=_FAR, aspectRatio=aspect)
        return camera.get_projection_matrix()

    def orbit(self, azimuth: float, elevation: float) -> View:
        """Turned about the target by these angles."""
        steep = float(np.clip(self.elevation + elevation, -_STEEPEST, _STEEPEST))
        return replace(self, azimuth=self.azimuth + azimuth, elevation=steep)

    def pan(self, right: float, up: float) -> View:
        """Shifted in the picture's plane, in shares of the picture's height."""
        T = self.pose()
        metres = 2.0 * self.distance * np.tan(0.5 * self.field_of_view)
        return replace(self, target=self.target + metres * (right * T[:3, 0] + up * T[:3, 1]))

    def zoom(self, factor: float) -> View:
        """Nearer (factor < 1) or farther."""
        return replace(self, distance=float(np.clip(self.distance * factor, 0.15, 60.0)))


def look_at(place: Array, target: Array, field_of_view: float | None = None) -> View:
    """The view from a place to a target."""
    back = np.asarray(place, float) - target
    distance = max(float(np.linalg.norm(back)), 1e-6)
    view = View(
        target=np.asarray(target, float),
        distance=distance,
        azimuth=float(np.arctan2(back[1], back[0])),
        elevation=float(np.arcsin(np.clip(back[2] / distance, -1.0, 1.0))),
    )
    return view if field_of_view is None else replace(view, field_of_view=field_of_view)


def project(places: Array, view: View, size: tuple[int, int]) -> Array:
    """World places (..., 3) to pixels from the top left and the depth in metres (..., 3); depth <= 0 is behind."""
    T_camera_world = np.linalg.inv(view.pose())
    seen = np.asarray(places, float) @ T_camera_world[:3, :3].T + T_camera_world[:3, 3]
    P = view.projection(size[0] / size[1])
    depth = -seen[..., 2]
    safe = np.where(np.abs(depth) < 1e-9, 1e-9, depth)
    x = (0.5 + 0.5 * P[0, 0] * seen[..., 0] / safe) * size[0]
    y = (0.5 - 0.5 * P[1, 1] * seen[..., 1] / safe) * size[1]
    return np.stack([x, y, depth], axis=-1)
