"""Shadow maps: what the sun sees, as depths."""

from __future__ import annotations

from typing import Any

import numpy as np
from OpenGL import GL

from ahmss.body.array import Array

__all__ = ["ShadowMap", "corners_of", "sun_view"]

_TO_TEXTURE = np.array([[0.5, 0.0, 0.0, 0.5], [0.0, 0.5, 0.0, 0.5], [0.0, 0.0, 0.5, 0.5], [0.0, 0.0, 0.0, 1.0]])


def sun_view(sun: Array, bounds: Array | None, margin: float = 0.1) -> Array:
    """The sun's orthographic view T_clip_world (4, 4) of a box (2, 3); sun (3,) points towards it."""
    if bounds is None:
        bounds = np.array([[-1.0, -1.0, -1.0], [1.0, 1.0, 1.0]])
    z = sun / np.linalg.norm(sun)
    x = np.cross([0.0, 1.0, 0.0], z)
    x /= np.linalg.norm(x)
    turn = np.stack([x, np.cross(z, x), z])
    corners = corners_of(bounds) @ turn.T
    low, high = corners.min(axis=0) - margin, corners.max(axis=0) + margin
    T = np.eye(4)
    scale = 2.0 / (high - low) * np.array([1.0, 1.0, -1.0])
    T[:3, :3] = scale[:, None] * turn
    T[:3, 3] = -scale * 0.5 * (low + high)
    return T


def corners_of(bounds: Array) -> Array:
    """The eight corners (8, 3) of a box (2, 3)."""
    choice = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
    return np.where(choice == 0, bounds[0], bounds[1])


class ShadowMap:
    """A square depth texture with hardware comparison; outside of it everything is in the sun.

    `smooth` blends the four nearest answers, which costs a fifth of a picture without a GPU.
    """

    def __init__(self, size: int, *, smooth: bool) -> None:
        self.size = size
        self.T_clip_world: Array = np.eye(4)
        self.texture: Any = GL.glGenTextures(1)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self.texture)
        GL.glTexImage2D(
            GL.GL_TEXTURE_2D, 0, GL.GL_DEPTH_COMPONENT16, size, size, 0,
            GL.GL_DEPTH_COMPONENT, GL.GL_UNSIGNED_SHORT, None,
        )  # fmt: skip
        blend = GL.GL_LINEAR if smooth else GL.GL_NEAREST
        for name, value in (
            (GL.GL_TEXTURE_MIN_FILTER, blend), (GL.GL_TEXTURE_MAG_FILTER, blend),
            (GL.GL_TEXTURE_WRAP_S, GL.GL_CLAMP_TO_BORDER), (GL.GL_TEXTURE_WRAP_T, GL.GL_CLAMP_TO_BORDER),
            (GL.GL_TEXTURE_COMPARE_MODE, GL.GL_COMPARE_REF_TO_TEXTURE), (GL.GL_TEXTURE_COMPARE_FUNC, GL.GL_LEQUAL),
        ):  # fmt: skip
            GL.glTexParameteri(GL.GL_TEXTURE_2D, name, value)
        GL.glTexParameterfv(GL.GL_TEXTURE_2D, GL.GL_TEXTURE_BORDER_COLOR, np.ones(4, np.float32))
        self._framebuffer: Any = GL.glGenFramebuffers(1)
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        GL.glFramebufferTexture2D(GL.GL_FRAMEBUFFER, GL.GL_DEPTH_ATTACHMENT, GL.GL_TEXTURE_2D, self.texture, 0)
        GL.glDrawBuffer(GL.GL_NONE)
        GL.glReadBuffer(GL.GL_NONE)

    def to_texture(self) -> Array:
        """T_texture_world: from the world to texture coordinates and depth, each 0..1."""
        return _TO_TEXTURE @ self.T_clip_world

    def begin(self, T_clip_world: Array, *, clear: bool = True) -> None:
        """Draw into the map from now on, seen by this view."""
        self.T_clip_world = T_clip_world
        GL.glBindFramebuffer(GL.GL_FRAMEBUFFER, self._framebuffer)
        GL.glViewport(0, 0, self.size, self.size)
        if clear:
            GL.glClear(GL.GL_DEPTH_BUFFER_BIT)
        GL.glEnable(GL.GL_POLYGON_OFFSET_FILL)
        GL.glPolygonOffset(1.5, 2.0)

    @staticmethod
    def end() -> None:
        """Stop drawing into maps."""
        GL.glDisable(GL.GL_POLYGON_OFFSET_FILL)

    def take(self, other: ShadowMap, bounds: Array | None) -> bool:
        """Hold what another map of this size holds, and then draw more into it.

        Args:
            other: seen as this one was seen when it was last taken from whole.
            bounds: the box (2, 3) in the world in which this map may differ from the other; None: everywhere.

        Returns:
            False where this OpenGL can't copy.
        """
        copy: Any = GL.glCopyImageSubData
        if not copy:
            return False
        low, high = np.zeros(2, int), np.full(2, self.size)
        if bounds is not None:
            seen = corners_of(bounds) @ self.to_texture()[:2, :3].T + self.to_texture()[:2, 3]
            low = np.clip(np.floor(seen.min(axis=0) * self.size) - 2, 0, self.size).astype(int)
            high = np.clip(np.ceil(seen.max(axis=0) * self.size) + 2, 0, self.size).astype(int)
        (left, bottom), (width, height) = low.tolist(), (high - low).tolist()
        if width > 0 and height > 0:
            kind = GL.GL_TEXTURE_2D
            copy(other.texture, kind, 0, left, bottom, 0, self.texture, kind, 0, left, bottom, 0, width, height, 1)
        return True

    def bind(self, unit: int) -> None:
        """Let shaders read it from a texture unit."""
        GL.glActiveTexture(int(GL.GL_TEXTURE0) + unit)
        GL.glBindTexture(GL.GL_TEXTURE_2D, self.texture)

    def delete(self) -> None:
        """Free it."""
        GL.glDeleteFramebuffers(1, [self._framebuffer])
        GL.glDeleteTextures([self.texture])
